"""``gcs reproduce``: the paper's simulations, figures and numbers, as printed and as corrected."""
