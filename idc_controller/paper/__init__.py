"""What the paper prints, line by line, for comparison with what is correct: equations, matrices, controller, filter."""
