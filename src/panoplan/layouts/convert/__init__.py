"""Other people's layout networks become ONNX files that say what their outputs mean."""
