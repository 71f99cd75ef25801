"""panoplan: a walk with a 360° camera becomes a floor plan."""

from __future__ import annotations

__version__ = "0.1.0"
