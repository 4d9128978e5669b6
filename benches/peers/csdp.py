"""CSDP beside `optimize` on a mixed H2/H-infinity program and on SDPLIB: objectives and times of both.

    sudo apt-get install coinor-csdp
    cargo build --release -p washboard --example bench_sdp
    python3 benches/peers/csdp.py [STATES ...]

CSDP's objective (primal) is washboard's bound, its dual one washboard's objective.
"""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BENCH = ROOT / "target/release/examples/bench_sdp"
SDPLIB = ROOT.parent / "shared/data/sdplib"


def csdp(file):
    begin = time.perf_counter()
    said = subprocess.run(["csdp", file], capture_output=True, text=True, cwd=tempfile.gettempdir())
    took = time.perf_counter() - begin
    found = [re.search(rf"{what} objective value: (\S+)", said.stdout) for what in ("Primal", "Dual")]
    values = [m.group(1) if m else "none" for m in found]
    steps = len(re.findall(r"^Iter:", said.stdout, re.M))
    return f"{took:.2f} s, {steps} iterations, {values[1]} >= {values[0]}, exit {said.returncode}"


def main():
    for states in sys.argv[1:] or ["4", "8", "12", "18"]:
        with tempfile.NamedTemporaryFile("w", suffix=".dat-s", delete=False) as file:
            subprocess.run([BENCH, "write", states], stdout=file, check=True)
        print(subprocess.run([BENCH, states], capture_output=True, text=True, check=True).stdout.strip())
        print("  CSDP:", csdp(file.name))
        Path(file.name).unlink()
    for file in sorted(SDPLIB.glob("*.dat-s")):
        print(file.stem, "CSDP:", csdp(file))


main()
