"""Drawings on paper in true scale: composed once in millimetres, written as SVG or PDF."""
