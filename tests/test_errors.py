import pickle

import pytest

from panoplan.errors import ConfigError, InputError, MissingExtraError, PanoplanError


@pytest.mark.parametrize(
    "error",
    [
        PanoplanError("one line"),
        InputError("plan.json", "nothing", "a plan"),
        ConfigError("scale.cells", "an unknown setting", "scale.cells_ch"),
        MissingExtraError("DXF", "ezdxf", "export"),
    ],
)
def test_errors_come_whole_from_another_process(error):
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert vars(again) == vars(error)
