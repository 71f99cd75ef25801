"""Layouts from panoramas by a network that ONNX Runtime runs on the CPU."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from panoplan.errors import InputError, MissingExtraError
from panoplan.formats.atomic import read_bytes
from panoplan.formats.image import Pixels, resized
from panoplan.layouts import dense
from panoplan.layouts.contract import METADATA_KEY, parse_spec
from panoplan.layouts.decode import decode
from panoplan.layouts.dense import Dense

Averaging = Literal["flip", "rotate"]
_FILE_LIMIT = 2**30
_QUIET = 4


SHIPPED = Path(__file__).parent / "models" / "panoplan-layout-s.onnx"


class OnnxLayouts:
    """A layout network.

    Args:
        path: ONNX file of at most 1 GiB with the metadata of docs/models.md.
        averaging: "flip" to ask about the mirrored panorama as well, "rotate" about quarter turns.
        threads: that one panorama may use; 0 lets ONNX Runtime choose.

    Raises:
        InputError: no ONNX file, metadata missing or wrong, or inputs and outputs other than it
            says.
        MissingExtraError: ONNX Runtime is not installed.
    """

    def __init__(
        self, path: Path, averaging: Sequence[Averaging] = (), *, threads: int = 0
    ) -> None:
        try:
            import onnxruntime
        except ImportError:
            raise MissingExtraError("a layout network", "onnxruntime", "images") from None
        data = read_bytes(path, _FILE_LIMIT)
        options = onnxruntime.SessionOptions()
        options.log_severity_level = _QUIET
        options.intra_op_num_threads = threads
        try:
            self._session = onnxruntime.InferenceSession(
                data, options, providers=["CPUExecutionProvider"]
            )
        except Exception as error:
            # ONNX Runtime's errors share no root but Exception.
            raise InputError(path, f"no ONNX model ({str(error)[:120]})", "an .onnx file") from None
        told = self._session.get_modelmeta().custom_metadata_map
        if METADATA_KEY not in told:
            expected = f"{METADATA_KEY}, which `panoplan model convert` writes"
            raise InputError(path, f"metadata {sorted(told)}", expected)
        self.spec = parse_spec(told[METADATA_KEY], path)
        self._path, self._averaging = path, tuple(averaging)
        self._check()
        self.fingerprint = hashlib.sha256(data + repr(self._averaging).encode()).hexdigest()

    def __call__(self, pixels: Pixels) -> Dense:
        """What the network says of a panorama.

        Args:
            pixels: (H, W, 3) RGB.

        Returns:
            Its answer, averaged where that was asked for.

        Raises:
            InputError: the network's answer has not the shape that its metadata says.
        """
        spec = self.spec
        small = resized(pixels, spec.width, spec.height).astype(np.float32)
        image = (small - np.array(spec.mean, np.float32)) / np.array(spec.std, np.float32)
        quarters = range(4) if "rotate" in self._averaging else range(1)
        answers = []
        for quarter in quarters:
            rolled = np.roll(image, quarter * spec.width // 4, axis=1)
            answer = self._run(rolled)
            back = -quarter * len(answer.floor) // 4
            answers.append(dense.turned(answer, back))
            if "flip" in self._averaging:
                mirror = dense.turned(self._run(rolled[:, ::-1]), 0, mirrored=True)
                answers.append(dense.turned(mirror, back))
        return dense.mean(answers)

    def _run(self, image: Any) -> Dense:
        names = list(dict.fromkeys(item.tensor for item in self.spec.outputs.values()))
        batch = np.ascontiguousarray(image.transpose(2, 0, 1)[None], dtype=np.float32)
        tensors = self._session.run(names, {self.spec.tensor: batch})
        return decode(self.spec, dict(zip(names, tensors, strict=True)), self._path)

    def _check(self) -> None:
        """Refuses metadata that names other tensors than the model has."""
        inputs = {item.name: item.shape for item in self._session.get_inputs()}
        outputs = {item.name for item in self._session.get_outputs()}
        wanted = [1, 3, self.spec.height, self.spec.width]
        shape = inputs.get(self.spec.tensor)
        if set(inputs) != {self.spec.tensor} or shape is None or len(shape) != 4:
            raise InputError(self._path, f"inputs {inputs}", f"one input {self.spec.tensor}")
        if any(isinstance(n, int) and n != m for n, m in zip(shape, wanted, strict=True)):
            raise InputError(self._path, f"an input of shape {shape}", f"{wanted}")
        missing = {item.tensor for item in self.spec.outputs.values()} - outputs
        if missing:
            raise InputError(self._path, f"outputs {sorted(outputs)}", f"{sorted(missing)}, too")
