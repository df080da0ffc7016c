"""Compiled kernel of a family of quadratic programs; see :mod:`idc_controller.qp.parametric`."""

import numpy as np

from idc_controller.arrays import Array1, Array2, Indices1
from idc_controller.compiled import kernel


@kernel
def optimum_and_rows(p: Array1, products: Array2, which: Indices1, sign: Array1, h: Array1) -> tuple[bool, Array1]:
    """Return whether the unconstrained optimum keeps all m rows, and the optimum (n,).

    Args:
        p: parameters (q,).
        products: rows of which optimum and left sides of the constraints are the products with ``p``, each column one
            of them (q, D).
        which, sign: the product that each element of the optimum is, and each left side, and its sign (n + m,).
        h: bounds of the rows (m,); a bound or a left side that is not a number is not kept.
    """
    values = np.zeros(products.shape[1])
    for k in range(len(p)):
        weight = p[k]
        for c in range(len(values)):
            values[c] += weight * products[k, c]
    n = len(which) - len(h)
    x = np.empty(n)
    for r in range(n):
        x[r] = sign[r] * values[which[r]]
    for r in range(len(h)):
        if not sign[n + r] * values[which[n + r]] <= h[r]:
            return False, x
    return True, x
