"""washboard's `care` against slycot's sb02md (and its pencil method sb02od) on the same plants, one thread. By hand:

    cargo build --release --example bench_riccati
    OPENBLAS_NUM_THREADS=1 python benches/peers/slycot_riccati.py target/release/examples/bench_riccati

Needs numpy and slycot (`pip install slycot`). The example writes its plants, its X and its median times to a temporary file;
the two programs then take turns, three rounds, so that other load on the machine meets both. The best round counts.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import slycot

ROUNDS = 3
AGREEMENT = 1e-10  # of X, relative: both are good to about the condition number (below 1e5 here) times 1e-16


def timed(work) -> float:
    times = []
    end = time.perf_counter() + 0.6
    while time.perf_counter() < end or len(times) < 5:
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e6 * float(np.median(times))


def residual(a, g, q, x) -> float:
    size = np.linalg.norm(x)
    terms = 2 * np.linalg.norm(a) * size + size**2 * np.linalg.norm(g) + np.linalg.norm(q)
    return float(np.linalg.norm(a.T @ x + x @ a - x @ g @ x + q) / terms)


def read(path: Path) -> dict:
    found = {}
    for line in path.read_text().splitlines():
        n, name, rows, cols, *values = line.split(",")
        found.setdefault(int(n), {})[name] = np.array(values, dtype=float).reshape(int(rows), int(cols))
    return found


def main() -> None:
    best = {}
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory() as directory:
            path = Path(directory) / "plants.csv"
            subprocess.run([sys.argv[1], str(path)], check=True, capture_output=True)
            plants = read(path)
        for n, p in plants.items():
            a, q, b = p["A"], p["Q"], p["B"]
            g = b @ b.T
            ours = float(p["median_us"][0, 0])
            md = timed(lambda: slycot.sb02md(n, a, g, q, "C"))
            od = timed(lambda: slycot.sb02od(n, b.shape[1], a, b, q, np.eye(b.shape[1]), "C"))
            row = best.setdefault(n, [np.inf] * 3)
            best[n] = [min(x, y) for x, y in zip(row, (ours, md, od))]
    print(f"{'n':>4} {'ours µs':>10} {'sb02md µs':>10} {'sb02od µs':>10} {'residual':>10} {'sb02md':>10} {'X differs':>10}")
    for n, p in plants.items():
        a, q, b, x = p["A"], p["Q"], p["B"], p["X"]
        g = b @ b.T
        other = slycot.sb02md(n, a, g, q, "C")[0]
        differs = np.linalg.norm(x - other) / np.linalg.norm(x)
        print(f"{n:>4} {best[n][0]:>10.1f} {best[n][1]:>10.1f} {best[n][2]:>10.1f} {residual(a, g, q, x):>10.1e} "
              f"{residual(a, g, q, other):>10.1e} {differs:>10.1e}")
        assert differs < AGREEMENT


if __name__ == "__main__":
    main()
