"""Types of arrays: of any number of axes, and contiguous ones of a given number, for which kernels are compiled."""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Indices = NDArray[np.intp]
Cells = NDArray[np.uint8]
Links = NDArray[np.int32]


class Layout(NamedTuple):
    """Number of axes of a contiguous array, and whether a kernel only reads it: then it may be write-protected."""

    axes: int
    is_read_only: bool = False


Array1 = Annotated[Array, Layout(1)]
Array2 = Annotated[Array, Layout(2)]
Array3 = Annotated[Array, Layout(3)]
Array4 = Annotated[Array, Layout(4)]
Const1 = Annotated[Array, Layout(1, True)]
Const2 = Annotated[Array, Layout(2, True)]
Const3 = Annotated[Array, Layout(3, True)]
Indices1 = Annotated[Indices, Layout(1)]
Indices2 = Annotated[Indices, Layout(2)]
ConstIndices2 = Annotated[Indices, Layout(2, True)]
Mask1 = Annotated[Mask, Layout(1)]
Mask2 = Annotated[Mask, Layout(2)]
Links1 = Annotated[Links, Layout(1)]
Links2 = Annotated[Links, Layout(2)]
Cells1 = Annotated[Cells, Layout(1)]
Cells2 = Annotated[Cells, Layout(2)]
Floats2 = Annotated[NDArray[np.float32], Layout(2)]
