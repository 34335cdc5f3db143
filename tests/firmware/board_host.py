# SPDX-License-Identifier: Apache-2.0
"""A host for a board that speaks DTS sample frames, written from the description of the protocol and not from the firmware.

Board runs simavr_board as a child process. A wait ends with an error after LIMIT_S: a test never waits for a fixed time.
"""

import os
import pathlib
import select
import struct
import subprocess
import termios
import time
import tty
import zlib

LIMIT_S = 120.0

DESCRIPTOR, CHANNEL, SCANS, LOST, LOG = 1, 2, 3, 4, 5
DESCRIBE, START, STOP, PATTERN = 0x81, 0x82, 0x83, 0x84


def encode(payload: bytes) -> bytes:
    """Returns a payload as a frame: CRC-32, COBS, zero byte."""
    data = payload + struct.pack("<I", zlib.crc32(payload))
    return b"".join(bytes([len(part) + 1]) + part for part in data.split(b"\0")) + b"\0"


def decode(frame: bytes) -> bytes:
    """Returns the payload of a frame without its zero byte. Raises ValueError if the frame is damaged."""
    data = bytearray()
    at = 0
    while at < len(frame):
        code = frame[at]
        part = frame[at + 1 : at + code]
        if len(part) != code - 1:
            raise ValueError("a COBS code points behind the end")
        data += part
        at += code
        if at < len(frame):
            data.append(0)
    payload, crc = bytes(data[:-4]), data[-4:]
    if struct.pack("<I", zlib.crc32(payload)) != crc:
        raise ValueError("wrong CRC")
    return payload


def _text(data: bytes, at: int):
    end = at + 1 + data[at]
    if end > len(data):
        raise ValueError("a text is longer than its frame")
    return data[at + 1 : end].decode("utf-8"), end


def parse(payload: bytes) -> dict:
    """Returns the fields of a payload. Raises ValueError if its length is not exact."""
    kind = payload[0]
    if kind == DESCRIPTOR:
        version, channels, bits, numerator, denominator, ticks, flags = struct.unpack_from("<BBBIIIB", payload, 1)
        at = 17
        texts = []
        for _ in range(3):
            text, at = _text(payload, at)
            texts.append(text)
        fields = dict(version=version, channels=channels, bits=bits, rate=(numerator, denominator), ticks_per_s=ticks, flags=flags,
                      serial=texts[0], model=texts[1], firmware=texts[2])
    elif kind == CHANNEL:
        index, flags, lowest, highest, scale, offset = struct.unpack_from("<BBhhff", payload, 1)
        name, at = _text(payload, 15)
        unit, at = _text(payload, at)
        fields = dict(index=index, flags=flags, lowest=lowest, highest=highest, scale=scale, offset=offset, name=name, unit=unit)
    elif kind == SCANS:
        run, counter, ticks, count = struct.unpack_from("<BIIB", payload, 1)
        codes = struct.unpack(f"<{(len(payload) - 11) // 2}h", payload[11:])
        if count == 0 or len(codes) % count:
            raise ValueError("the number of codes does not fit the number of scans")
        width = len(codes) // count
        fields = dict(run=run, counter=counter, ticks=ticks, scans=[codes[i * width : (i + 1) * width] for i in range(count)])
        at = 11 + 2 * len(codes)
    elif kind == LOST:
        run, counter, reason, lost = struct.unpack_from("<BIBI", payload, 1)
        fields = dict(run=run, counter=counter, reason=reason, lost=lost)
        at = 11
    elif kind == LOG:
        fields = dict(text=payload[1:].decode("utf-8"))
        at = len(payload)
    else:
        raise ValueError(f"unknown type {kind}")
    if at != len(payload):
        raise ValueError(f"{len(payload) - at} bytes too many in a frame of type {kind}")
    return dict(kind=kind, size=len(payload), **fields)


def wave(channel: int, conversion: int) -> int:
    """Returns the code of the test wave of simavr_board."""
    return (conversion * (2 * channel + 3) + 100 * channel) % 1024


def conversion_of(channel: int, code: int) -> int:
    """Returns the conversion, modulo 1024, at which the test wave has this code."""
    return (code - 100 * channel) * pow(2 * channel + 3, -1, 1024) % 1024


class Board:
    """simavr_board and its port. `damaged` counts frames that were not good."""

    def __init__(self, elf: str, *options: str):
        program = pathlib.Path(os.environ["DTS_BIN_DIR"]) / "simavr_board"
        firmware = pathlib.Path(os.environ["DTS_FIRMWARE_DIR"]) / elf
        self.process = subprocess.Popen([program, firmware, *options], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        if not line.startswith("port "):
            self.process.kill()
            raise RuntimeError(f"simavr_board says {line!r}")
        self.path = line.split()[1]
        self.port = -1
        self.damaged = 0
        self._rest = b""
        self._frames = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.port >= 0:
            os.close(self.port)
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()

    def open(self):
        self.port = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.port)
        termios.tcflush(self.port, termios.TCIFLUSH)

    def ask(self, command: str) -> str:
        """Gives a command to simavr_board, reads the port until the answer is there, and returns it."""
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        end = time.monotonic() + LIMIT_S
        while not select.select([self.process.stdout], [], [], 0)[0]:
            if time.monotonic() > end:
                raise TimeoutError(f"simavr_board does not answer to {command!r}")
            if self.port >= 0:
                self._receive(0.05)
        answer = self.process.stdout.readline().strip()
        if not answer.startswith("ok"):
            raise RuntimeError(f"{command}: {answer}")
        return answer[3:]

    def send(self, kind: int, *fields: bytes):
        os.write(self.port, encode(bytes([kind]) + b"".join(fields)))

    def start(self, numerator: int = 0, denominator: int = 1):
        self.send(START, struct.pack("<II", numerator, denominator))

    def _receive(self, wait_s: float):
        if not select.select([self.port], [], [], wait_s)[0]:
            return
        *frames, self._rest = (self._rest + os.read(self.port, 65536)).split(b"\0")
        for frame in filter(None, frames):
            try:
                self._frames.append(parse(decode(frame)))
            except (ValueError, struct.error, IndexError):
                self.damaged += 1

    def frame(self) -> dict:
        """Returns the next good frame."""
        end = time.monotonic() + LIMIT_S
        while not self._frames:
            if time.monotonic() > end:
                raise TimeoutError("no frame")
            self._receive(0.2)
        return self._frames.pop(0)

    def waiting(self) -> list:
        """Returns the good frames that are there. Call it while the board is paused."""
        while select.select([self.port], [], [], 0.2)[0]:
            self._receive(0)
        frames, self._frames = self._frames, []
        return frames

    def until(self, kind: int, **fields) -> list:
        """Returns all frames up to the first one of this kind with these fields, that one included."""
        frames = []
        while True:
            frames.append(self.frame())
            if frames[-1]["kind"] == kind and all(frames[-1][name] == value for name, value in fields.items()):
                return frames

    def describe(self) -> tuple:
        """Returns the descriptor and the channels that answer DESCRIBE."""
        self.send(DESCRIBE)
        return self.description()

    def description(self) -> tuple:
        descriptor = self.until(DESCRIPTOR)[-1]
        return descriptor, [self.until(CHANNEL, index=i)[-1] for i in range(descriptor["channels"])]


class ScanChecker:
    """Checks scans of the test wave: counter, ticks and every code. A break is an AssertionError; a reported loss is not."""

    def __init__(self, period: int):
        self.period = period
        self.run = self.counter = self.ticks = self.conversion = None
        self.scans = self.lost = 0

    def take(self, frame: dict):
        if frame["kind"] == LOST:
            self._lost(frame)
        if frame["kind"] != SCANS:
            return
        if self.run is None:
            self.run, self.counter, self.ticks = frame["run"], frame["counter"], frame["ticks"]
            self.conversion = conversion_of(0, frame["scans"][0][0])
        assert frame["run"] == self.run, f"run {frame['run']} in run {self.run}"
        assert frame["counter"] == self.counter, f"counter {frame['counter']}, expected {self.counter}"
        assert frame["ticks"] == self.ticks, f"ticks {frame['ticks']}, expected {self.ticks}"
        for codes in frame["scans"]:
            expected = tuple(wave(channel, self.conversion) for channel in range(len(codes)))
            assert codes == expected, f"scan {self.counter}: {codes}, expected {expected}"
            self._step(1)
            self.conversion += 1
            self.scans += 1

    def _lost(self, frame: dict):
        if self.run is None:
            return
        assert frame["run"] == self.run
        self._step(frame["lost"])
        self.lost += frame["lost"]
        assert frame["counter"] == self.counter, f"LOST says {frame['counter']}, expected {self.counter}"

    def _step(self, scans: int):
        self.counter = (self.counter + scans) % 2**32
        self.ticks = (self.ticks + scans * self.period) % 2**32
