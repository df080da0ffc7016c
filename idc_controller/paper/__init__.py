"""The paper as printed, line by line, for comparison with what is correct: equations, controller, filter."""
