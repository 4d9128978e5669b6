"""washboard's Welch spectra against scipy.signal.csd, and the time of either. By hand:

    cargo build --release --example welch_spectra
    python benches/peers/welch_scipy.py target/release/examples/welch_spectra

Needs numpy and scipy. Twenty minutes of eight channels at 200 Hz are written to a temporary directory.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy import signal

RATE, SECONDS, CHANNELS, SEGMENT_S = 200.0, 1200, 8, 5.0
TOLERANCE = 1e-10  # both sum some thousand products in double precision; CSV holds 17 digits


def main() -> None:
    n = int(RATE * SECONDS)
    rng = np.random.default_rng(1)
    source = rng.standard_normal((3, n))
    mix = rng.standard_normal((CHANNELS, 3))
    x = signal.lfilter([1.0], [1.0, -1.5, 0.8], mix @ source) + 0.1 * rng.standard_normal((CHANNELS, n))
    x[1] = np.roll(x[0], 3)
    with tempfile.TemporaryDirectory() as directory:
        run = Path(directory) / "RUN.toml"
        names = [f"c{i}" for i in range(CHANNELS)]
        table = np.column_stack([np.arange(n) / RATE, x.T])
        np.savetxt(Path(directory) / "RUN.csv", table, fmt="%.17g", delimiter=",", header="t," + ",".join(names), comments="")
        channel = '[[channel]]\ncolumn = "{}"\nquantity = "acceleration"\nunit = "m/s^2"\ndirection = "+z"\nplace = "body"\n'
        run.write_text(f'data = "RUN.csv"\nrate_hz = {RATE}\n' + "".join(channel.format(c) for c in names))
        out = subprocess.run([sys.argv[1], str(run), str(SEGMENT_S)], capture_output=True, text=True, check=True)
    print(out.stderr.strip())
    head, *rows = out.stdout.splitlines()
    ours = dict(zip(head.split(","), np.array([r.split(",") for r in rows], dtype=float).T))
    length = int(SEGMENT_S * RATE)
    start = time.perf_counter()
    worst = 0.0
    for i in range(CHANNELS):
        for j in range(i, CHANNELS):
            f, s = signal.csd(x[i], x[j], RATE, window="hann", nperseg=length, noverlap=length * 3 // 4,
                              detrend="constant", return_onesided=False)
            s = s[: length // 2 + 1]
            name = f"psd_{i + 1}{j + 1}"
            mine = ours[name] if i == j else ours[name + "_re"] + 1j * ours[name + "_im"]
            worst = max(worst, np.max(np.abs(mine - s)) / np.max(np.abs(s)))
    print(f"scipy: {CHANNELS * (CHANNELS + 1) // 2} spectra in {time.perf_counter() - start:.3f} s")
    print(f"largest difference over the largest value, all pairs: {worst:.2e} (tolerance {TOLERANCE:.0e})")
    assert worst < TOLERANCE


if __name__ == "__main__":
    main()
