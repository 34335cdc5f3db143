# SPDX-License-Identifier: Apache-2.0
"""What receiving 16 channels at 1500 Hz costs: python3 tests/python/bench_stream.py [SECONDS]. Prints figures, decides nothing."""
import resource
import sys
import time

from support import DaemonProcess


def measure(process: DaemonProcess, topics: tuple[str, ...], seconds: float) -> None:
    with process.connect() as daemon, daemon.stream(*topics) as stream:
        next(stream)
        begun_s = time.monotonic()
        cpu_s = time.process_time()
        scans = lost = blocks = 0
        for block in stream:
            scans += len(block) if block.topic == topics[0] else 0
            lost += block.lost_scans
            blocks += 1
            if time.monotonic() - begun_s >= seconds:
                break
        wall_s = time.monotonic() - begun_s
        cpu_s = time.process_time() - cpu_s
    print(f"{' '.join(topics)}: {wall_s:.1f} s, {scans} scans of {block.values.shape[1]} channels ({scans / wall_s:.1f} Hz), {lost} lost")
    print(f"  {cpu_s / wall_s:.2%} of a core, {cpu_s / blocks * 1e6:.0f} us a block; memory {memory_mib():.0f} MiB")


def memory_mib() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    wanted_s = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    daemon_process = DaemonProcess(chair_streams=("raw", "deflection", "transient", "aux"))
    try:
        measure(daemon_process, ("chair/raw",), wanted_s)
        measure(daemon_process, ("chair/raw", "chair/deflection", "chair/transient"), wanted_s)
    finally:
        daemon_process.close()
