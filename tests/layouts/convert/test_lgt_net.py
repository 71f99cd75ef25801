import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from panoplan.cli.main import main
from panoplan.errors import InputError
from panoplan.layouts.convert.checkpoints import convert
from panoplan.layouts.onnx import OnnxLayouts


def network(path, outputs=("depth", "ratio")):
    """A network with the inputs and outputs of LGT-Net: depth 2 everywhere, ratio 0.8."""
    image = helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, 512, 1024])
    depth = helper.make_tensor_value_info(outputs[0], TensorProto.FLOAT, [1, 256])
    ratio = helper.make_tensor_value_info(outputs[1], TensorProto.FLOAT, [1, 1])
    constants = [
        helper.make_node(
            "Constant", [], [n], value=numpy_helper.from_array(np.full(s, v, np.float32))
        )
        for n, s, v in ((outputs[0], (1, 256), 2.0), (outputs[1], (1, 1), 0.8))
    ]
    graph = helper.make_graph(constants, "lgt", [image], [depth, ratio])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    onnx.save(model, str(path))
    return path


def test_an_lgt_net_file_is_told_what_its_outputs_mean(tmp_path, capsys):
    source, target = network(tmp_path / "lgt.onnx"), tmp_path / "out.onnx"
    assert main(["model", "convert", str(source), "-o", str(target)]) == 0
    told = OnnxLayouts(target)(np.zeros((512, 1024, 3), dtype=np.uint8))
    assert told.floor.shape == (256,)
    np.testing.assert_allclose(told.floor, -np.arctan(0.5), atol=1e-6)
    np.testing.assert_allclose(told.ceiling, np.arctan(0.4), atol=1e-6)
    capsys.readouterr()
    assert main(["model", "show", str(target)]) == 0
    assert "LGT-Net" in capsys.readouterr().out
    # Once more gives the same file.
    convert(target, tmp_path / "again.onnx")
    assert (tmp_path / "again.onnx").read_bytes() == target.read_bytes()


@pytest.mark.parametrize(
    "make",
    [
        lambda p: network(p, outputs=("depth", "height")),
        lambda p: p.write_bytes(b"\x80\x02}q\x00."),
        lambda p: p.write_bytes(b"PK nothing"),
    ],
)
def test_other_files_are_refused(tmp_path, make):
    make(tmp_path / "a.onnx")
    with pytest.raises(InputError, match=r"HorizonNet checkpoint"):
        convert(tmp_path / "a.onnx", tmp_path / "b.onnx")
    assert not (tmp_path / "b.onnx").exists()


def test_convert_needs_an_output(tmp_path, capsys):
    assert main(["model", "convert", str(network(tmp_path / "lgt.onnx"))]) == 2
    assert "-o FILE.onnx" in capsys.readouterr().err
