"""The parts of the differentiable pose solvers (training/solver.py). THE DOCSTRINGS OF THESE FILES
ARE THE DEFINITION that the C++ run time follows (pipeline/solver/); golden vectors hold the two
together.

Frames. Features are [C, 100, 50] at 0.6 m; row u lies at x = 30 - (u + 0.5) 0.6 m (row 0 is the
front), column v at y = 15 - (v + 0.5) 0.6 m (column 0 is the left). The correction (x, y, a) maps
vehicle points onto the map drawn at T0: p_M = R(a) p_B + t, a counter-clockwise seen from above.
Hypotheses: x = -2 ... +2 m by 0.2 (21), y = -1 ... +1 m by 0.2 (11), a = -2 ... +2 degrees by 0.2
(21), in increasing order. These are the defaults; `SolverDefinition` holds all of them.

| kind | scores | file |
|---|---|---|
| full | every hypothesis by warping and ZNCC: the reference | full.py, zncc.py |
| full-fft | the same from one warp and one cross-correlation per yaw | full_fft.py |
| decoupled-literal | the paper's steps word for word, of raw features | literal.py |
| decoupled | yaw signatures, then x and y from axis features | yaw.py, axis.py |
| banded | x, y and yaw from profiles of bands | banded.py |
| block | every hypothesis from correlations of blocks | block.py |
| ...+refine | three rounds of coordinate passes of ZNCC after any of the last four | refine.py |

Scores s become P = softmax(scale * s). All but decoupled-literal read standardised features
(features.py) and estimate by the means of their distributions (posterior.py).
"""
