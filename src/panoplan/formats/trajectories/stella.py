"""Maps of stella_vslam and OpenVSLAM as msgpack."""

from __future__ import annotations

from typing import Any

from panoplan.errors import InputError, MissingExtraError
from panoplan.formats.trajectories.matrices import from_cam_from_world
from panoplan.types.pose import Trajectory


def parse_stella(data: bytes, source: object) -> Trajectory:
    """Reads the keyframes of a map.

    Args:
        data: msgpack map with `keyframes`, each with `ts` (s), `rot_cw` (quaternion, scalar last)
            and `trans_cw`; everything else is passed over.
        source: for messages.

    Returns:
        Poses labelled with their times in seconds, to the microsecond, in the order of time.

    Raises:
        InputError: no such map, or a keyframe without its pose.
        MissingExtraError: msgpack is not installed.

    Source: stella_vslam, src/stella_vslam/data/keyframe.cc and common.cc.
    """
    try:
        import msgpack
    except ImportError:
        raise MissingExtraError("a stella_vslam map", "msgpack", "images") from None
    try:
        root: Any = msgpack.unpackb(data, strict_map_key=False)
    except (ValueError, msgpack.UnpackException, RecursionError):
        raise InputError(source, "no readable msgpack", "a stella_vslam map") from None
    keyframes = root.get("keyframes") if isinstance(root, dict) else None
    if not isinstance(keyframes, dict) or not keyframes:
        raise InputError(source, "no keyframes", "a stella_vslam map")
    labels, quaternions, translations = [], [], []
    for name, keyframe in keyframes.items():
        try:
            labels.append(f"{float(keyframe['ts']):.6f}")
            quaternions.append([float(x) for x in keyframe["rot_cw"]])
            translations.append([float(x) for x in keyframe["trans_cw"]])
        except (KeyError, TypeError, ValueError):
            where = f"{source}, keyframe {str(name)[:40]}"
            raise InputError(where, "no pose", "ts, rot_cw and trans_cw") from None
    return from_cam_from_world(labels, quaternions, translations, source)
