"""washboard's classical estimators beside pyOMA-2's on one simulated record: modes and times. By hand:

    cargo build --release --example oma_data
    python benches/peers/oma_pyoma2.py target/release/examples/oma_data

Needs pyoma-2. Four channels of 76 800 samples at 40 Hz; four modes of 1 to 10 % damping. pyOMA-2 is told where the modes
are (its `mpe` picks the stable pole nearest to a frequency given); washboard finds them.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from pyoma2.algorithms import EFDD, SSI, pLSCF
from pyoma2.setup import SingleSetup


def timed(setup, algorithm, **mpe):
    setup.add_algorithms(algorithm)
    start = time.perf_counter()
    setup.run_by_name(algorithm.name)
    ran = time.perf_counter() - start
    setup.mpe(algorithm.name, **mpe)
    result = algorithm.result
    return np.ravel(result.Fn), np.ravel(result.Xi), ran, time.perf_counter() - start


def main() -> None:
    with tempfile.TemporaryDirectory() as directory:
        subprocess.run([sys.argv[1], directory], check=True, capture_output=True)
        data = np.loadtxt(Path(directory) / "data.csv", delimiter=",")
        ours = json.loads((Path(directory) / "washboard.json").read_text())
    truth = np.array(ours["truth"])
    freqs = truth[:, 0].tolist()
    setup = SingleSetup(data, fs=ours["rate_hz"])
    theirs = {
        "ssi": (SSI(name="ssi", method="cov", br=50, ordmax=60, step=2), {"sel_freq": freqs, "order_in": "find_min"}),
        "plscf": (pLSCF(name="plscf", ordmax=40, nxseg=1024), {"sel_freq": freqs, "order": "find_min"}),
        "fdd": (EFDD(name="fdd", nxseg=ours["fdd"]["segment"]), {"sel_freq": freqs}),
    }
    print("truth    ", "  ".join(f"{f:.4f} Hz {100 * z:.2f} %" for f, z in truth))
    for name, (algorithm, mpe) in theirs.items():
        line = "  ".join(f"{f:.4f} Hz {100 * z:.2f} %" if z is not None else f"{f:.4f} Hz –" for f, z in ours[name]["modes"])
        print(f"{name}\n  washboard {line}   {ours[name]['seconds']:.3f} s, standard deviations included")
        try:
            f, z, ran, total = timed(setup, algorithm, **mpe)
            line = "  ".join(f"{a:.4f} Hz {100 * b:.2f} %" for a, b in zip(f, z))
            print(f"  pyOMA-2   {line}   {ran:.3f} s, with the picking {total:.3f} s")
        except Exception as error:  # a peer that refuses is told, the others go on
            print(f"  pyOMA-2   {type(error).__name__}: {error}")


if __name__ == "__main__":
    main()
