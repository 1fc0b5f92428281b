"""The parts of the differentiable pose solvers (training/solver.py). THE DOCSTRINGS OF THESE FILES
DEFINE what the C++ code in pipeline/solver/ implements. Golden vectors test that both agree.

Frames. Features are [C, 100, 50] with cells of 0.6 m. Row u lies at x = 30 - (u + 0.5) 0.6 m (row 0
is the front), column v at y = 15 - (v + 0.5) 0.6 m (column 0 is the left). The correction
(x, y, a) maps vehicle points onto the map drawn at T0: p_M = R(a) p_B + t with t = (x, y) and a
counter-clockwise seen from above. Hypotheses: x = -2 ... +2 m in steps of 0.2 (21), y = -1 ... +1 m
in steps of 0.2 (11), a = -2 ... +2 degrees in steps of 0.2 (21), in increasing order. These are the
defaults of `SolverDefinition`, which holds all constants.

| kind | scores | file |
|---|---|---|
| full | ZNCC of every hypothesis by warping: the reference | full.py, zncc.py |
| full-fft | the same with one warp and one cross-correlation per yaw | full_fft.py |
| decoupled-literal | the paper's steps without changes, on raw features | literal.py |
| decoupled | yaw from signatures, then x and y from axis features | yaw.py, axis.py |
| banded | x, y and yaw from profiles of bands | banded.py |
| block | every hypothesis from correlations of blocks | block.py |
| ...+refine | three rounds of ZNCC along y, yaw and x after one of the last four | refine.py |

Scores s become probabilities P = softmax(scale * s). All solvers except decoupled-literal use
standardised features (features.py) and return the means of their distributions (posterior.py).
"""
