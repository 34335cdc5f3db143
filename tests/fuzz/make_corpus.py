#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""make_corpus.py [FOLDER] writes the seeds of all fuzz targets but xdf (make_xdf_corpus): shipped files, and small made-up ones, synthetic, one
for each thing that a target tells apart. They are committed. Needs protoc and python3-protobuf."""

import importlib
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFIG = ROOT / "config"
KEY_ZERO = "0" * 40
HASH = "$argon2id$v=19$m=65536,t=2,p=1$c29tZXNhbHRzb21lc2FsdA$RdescudvJCsgt3ub+b4dWRWJTmaaJObGRdescudvJCs"


def without_comments(text: str) -> str:
    """The same file, a third as long: comments are no food for a parser's fuzzer."""
    lines = (re.sub(r"\s+#[^'\"]*$", "", line) for line in text.splitlines())
    return "\n".join(line for line in lines if line.strip() and not line.startswith("#")) + "\n"


def shipped(name: str) -> str:
    return without_comments((CONFIG / name).read_text())


def messages():
    """The modules of proto/, made in a folder of their own."""
    protos = sorted((ROOT / "proto/dts/v1").glob("*.proto"))
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["protoc", f"--proto_path={ROOT / 'proto'}", f"--python_out={folder}", *map(str, protos)], check=True)
        sys.path.insert(0, folder)
        return [importlib.import_module(f"dts.v1.{name}_pb2") for name in ("control", "gateway", "stream", "fleet")]


def piece(message: bytes) -> bytes:
    return struct.pack("<H", len(message)) + message


def sensor_curves() -> dict[str, str]:
    points = "".join(f"[[point]]\ngap_mm = {4 + k}.0\nvolts = {4.5 - k * 0.7}\n" for k in range(5))
    facts = 'id = "sensor-1"\ncreated_utc = "2026-01-31T12:00:00Z"\nrig = "floor"\nsensor = "w1"\nrange_v = 10.0\nresidual_mv = 1.5\nrepeat_mv = 0.5\n'
    return {
        "two.toml": 'name = "two"\n[[point]]\ngap_mm = 0\nvolts = 0\n[[point]]\ngap_mm = 1e3\nvolts = -1e2\n',
        "measured.toml": f'name = "measured"\n[calibration]\n{facts}readings_per_gap = 3\nsamples_per_point = 100\n{points}',
        "hoa1405.toml": shipped("sensors/hoa1405-assumed.toml"),
    }


def force_plates() -> dict[str, str]:
    def matrix(diagonal: float) -> str:
        return str([[diagonal if row == column else 0 for column in range(6)] for row in range(6)])

    amplifier = "excitation_v = [10, 10, 10, 10, 10, 10]\ngain = [1e3, 1e3, 1e3, 1e3, 1e3, 1e3]\nsurface_mm = [1, 2, -40]\n"
    size = "a_mm = 120\nb_mm = 200\naz0_mm = -48\n"
    return {
        "kistler.toml": f'[force_plate]\nkind = "kistler8"\nscale_mv_per_n = [38, 38, 38, 38, 4, 4, 4, 4]\n{size}'
                        "cop_poly_x = [0, 0, 0, 0, 0, 0.1]\ncop_poly_y = [0, 0, 0, 0, 0, 0.1]\n[force_plate.tare]\nvolts = [0, 0, 0, 0, 0, 0, 0, 1]\n",
        "charge.toml": '[force_plate]\nkind = "kistler8"\naxes = "z_up"\nsensitivity_pc_per_n = [-8, -8, -8, -8, -4, -4, -4, -4]\n'
                       f"range_pc = [1e4, 1e4, 1e4, 1e4, 1e4, 1e4, 1e4, 1e4]\nfull_scale_v = 10\n{size}",
        "matrix.toml": f'[force_plate]\nkind = "six_component"\nmatrix = {matrix(100)}\nmatrix_unit = "n_per_v"\nsurface_mm = [0, 0, -40]\n',
        "sensitivity.toml": f'[force_plate]\nkind = "six_component"\nsensitivity = {matrix(0.6)}\n{amplifier}',
        "cells.toml": '[force_plate]\nkind = "load_cells"\nposition_mm = [[200, 100], [-200, 100], [0, -100]]\nscale_n_per_v = [100, 100, 99]\n',
    }


def force_texts() -> dict[str, str]:
    rows = "".join(f"{k / 100:.2f},1,2,-{700 + k},{k},{-k},3\n" for k in range(20))
    bioware = "BioWare Version 5.2.1.3 Export\r\nDevice:\tKistler\r\nRate (Hz):\t1000,0\r\n"
    names = "\t".join(["time"] + [f"ground_{part}" for part in ("force_vx", "force_vy", "force_vz", "force_px", "force_py", "force_pz", "torque_y")])
    return {
        "columns.csv": f"Bertec\n\nTime (s),Fx (N),Fy (N),Fz (N),Mx (Nm),My (Nm),Mz (Nm)\n{rows}",
        "motive.csv": "Device Name,AMTI\n\n\nMocapFrame,MocapTime,DeviceFrame,Fx,Fy,Fz,Mx,My,Mz,Cx,Cy,Cz\n"
                      "0,0.0,0,1,2,700,3,4,5,0,0,0\n0,0.0,1,1,2,700,3,4,5,0,0,0\n1,0.01,2,1,2,700,3,4,5,0,0,0\n",
        "bioware.txt": f"{bioware}abs time (s)\tFx\tFy\tFz\tAx\tAy\tTz'\r\n\tN\tN\tN\tm\tm\tN.m\r\n0,000\t1,5\t2\t700\t0,1\t0,2\t1\r\n0,001\t1\t2\t7\t0\t0\t1\r\n",
        "opensim.mot": f"w\nversion=1\nnRows=2\nnColumns=8\ninDegrees=yes\nendheader\n{names}\n0\t1\t700\t2\t0.1\t0\t0.2\t1\n0.01\t1\t700\t2\t0.1\t0\t0.2\t1\n",
        "raw.txt": force_plates()["cells.toml"] + "----\nt_s,c1,c2,c3\n0,1,2,3\n0.01,1,2,3\n0.02,0,0,0\n",
        "cop.csv": "Time[s];COPx[cm];COPy[cm]\n0,00;1,25;-0,3\n0,01;;-0,3\n",
    }


def cop_calibration(method: str, parts: str, sensors: int = 4) -> str:
    figures = "rms_x_mm = 0.5\nrms_y_mm = 0.5\nrms_total_mm = 0.7\nmax_total_mm = 2.0\nload_rms_percent = 1.0\n"
    head = f'format = 1\nid = "cop-1"\ncreated_utc = "2026-01-31T12:00:00Z"\nrig = "floor"\nmethod = "{method}"\nsensors = {sensors}\n'
    valid = "[valid]\nx_mm = [86.0, 344.0]\ny_mm = [86.0, 344.0]\nload_n = [240.0, 850.0]\n"
    point = f"[[point]]\nx_mm = 215.0\ny_mm = 215.0\nload_n = 490.0\nw_mm = {[0.5] * sensors}\nx_error_mm = 0.1\ny_error_mm = -0.1\n"
    return f"{head}{valid}[residuals]\n{figures}[cross_validated]\n{figures}{parts}{point}"


def cop_calibrations() -> dict[str, str]:
    def rows(*firsts: float) -> str:
        return str([[first] + [0.0] * 5 + [129.0 if first == 215.0 else 0.0] + [0.0] * 14 for first in firsts])

    ranges = "u = [-1.0, 1.0]\nv = [-1.0, 1.0]\nrelative_sum = [0.2, 3.0]\nreference_sum_mm = 2.0\n"
    load = f"[polynomial]\n{ranges}sum_mm_per_n = {rows(0.004)}\n"
    ratio = "ratio = [0.1, 10.0]\nquartic = [215.0, -60.0, 1.0, 0.0, 0.0]\n"
    axes = {count: f"[[x_ratio]]\n{ratio}" * count + f"[[y_ratio]]\n{ratio}" * count for count in (1, 2)}
    five = str([0.2] * 5)
    moment = f"[moment]\nx_centre_mm = 215.0\ny_centre_mm = 215.0\nload_n_per_mm = {[200.0] * 5}\nx_moment_n = {five}\ny_moment_n = {five}\nshare = {[[0.0, 1.0]] * 5}\n"
    feet = "[two_feet]\ntravel_mm = 5.0\n"
    for table, means, sds in (("with_width", [215.0, 215.0, 650.0, 185.0], [20.0, 25.0, 180.0, 45.0]), ("without_width", [215.0, 215.0, 650.0], [20.0, 25.0, 180.0])):
        bounds = "".join(f"{key} = {[mean + side * 2 * sd for mean, sd in zip(means, sds)]}\n" for key, side in (("lowest", -1), ("highest", 1)))
        terms = "".join(f"{key} = {[first] + [0.1, -0.2] * 17}\n" for key, first in (("x_mm", 1.0), ("y_mm", -1.0), ("log_load", 0.1)))
        feet += f"[two_feet.{table}]\nmean = {means}\nsd = {sds}\n{bounds}{terms}"
    quadratic = f"x_quadratic_mm = {[1.0] * 15}\ny_quadratic_mm = {[1.0] * 15}\n"
    return {
        "poly3.toml": cop_calibration("poly3", load + f"x_mm = {rows(215.0)}\ny_mm = {rows(215.0)}\n"),
        "poly3-two.toml": cop_calibration("poly3", f"[polynomial]\n{ranges}sum_mm_per_n = {rows(0.004, 1e-4)}\nx_mm = {rows(215.0, 1.0)}\ny_mm = {rows(215.0, 1.0)}\n"),
        "two-feet.toml": cop_calibration("poly3", load + f"x_mm = {rows(215.0)}\ny_mm = {rows(215.0)}\n" + feet),
        "thesis.toml": cop_calibration("thesis", axes[1] + load),
        "thesis-per-pair.toml": cop_calibration("thesis_per_pair", axes[2] + load),
        "moment.toml": cop_calibration("moment", moment, 5),
        "moment-quadratic.toml": cop_calibration("moment", moment + quadratic, 5),
    }


def trunk_models() -> dict[str, str]:
    def head(kind: str) -> str:
        return (f'format = 1\nkind = "{kind}"\nreject_below = 0.9\np1_minimum_mm = 2.0\np1_maximum_mm = 5.0\n[training]\ndata_sha256 = "{"a" * 64}"\n'
                'subjects = ["A", "B"]\ntrials = 90\nseed = "18446744073709551615"\nsoftware = "made up"\n[figures]\nvalidation_accuracy = 0.97\n')

    def ensemble(name: str, features: list[str], output: str) -> str:
        weights = [((7 * k) % 11 - 5) / 2.0 for k in range(2 * (len(features) + 1) + 3 * 3)]
        return (f"[{name}]\nfeatures = {features}\nminimum = {[0.0] * len(features)}\nmaximum = {[0.6] * len(features)}\ntemperature = 1.5\n"
                f'[[{name}.network]]\nhidden = 2\noutput = "{output}"\nweights = {weights}\n')

    def quadratic(name: str, feature: str, rest: str) -> str:
        return f'[{name}]\nfeatures = ["{feature}"]\nminimum = [0.0]\nmaximum = [0.8]\ncoefficients = [0.4, 0.4, 0.1]\n{rest}\n'

    raw = ["d1_mm", "d2_mm", "p1_mm", "p2_mm", "p3_mm"]
    everything = (ensemble("general", ["d2_of_p1"], "softmax") + ensemble("own", ["d2_of_own_max"], "logistic") +
                  quadratic("angle", "d2_of_p1", "residual_deg = [3.0, 6.0, 9.0]") + quadratic("own_angle", "d2_of_own_max", "residual_deg = [2.0, 4.0, 6.0]") +
                  quadratic("arm_alone", "d2_of_p1", "none_from = 0.9"))
    return {"raw5.toml": head("raw5") + ensemble("general", raw, "logistic"), "recommended.toml": head("recommended") + everything}


def rigs() -> dict[str, str]:
    curve = 'curve = {name = "c", point = [{gap_mm = 4.0, volts = 4.5}, {gap_mm = 13.0, volts = 0.9}]}\n'
    stages = "".join(f'[[stage]]\nid = "{stage}"\n' for stage in ("guard", "window_filter", "linearise"))
    corners = [(86.0, 86.0), (344.0, 86.0), (86.0, 344.0), (344.0, 344.0)]
    plate = '[plate]\na_mm = 430.0\nb_mm = 430.0\nh_mm = 3.0\ne_pa = 198.7e9\nnu = 0.27\n[support]\nkind = "corner"\ninset_mm = 10.75\n'

    def sensors(places) -> str:
        return "".join(f'[[sensor]]\nlabel = "w{k + 1}"\nx_mm = {x}\ny_mm = {y}\n{curve}' for k, (x, y) in enumerate(places))

    extras = '[acquire]\nrate_hz = 1500.0\nblock_ms = 5.0\n[trigger]\nchannel = 4\nlevel = 2.5\nhysteresis = 0.2\nedges = "both"\n[session]\nsync_pulse_ms = 10.0\nsync_pulse_every_ms = 1000.0\n[record]\nstreams = ["raw"]\n[publish]\nstreams = ["raw", "cop"]\n'
    calibration = re.sub(r"(?s)\[\[point\]\].*", "", cop_calibrations()["thesis.toml"])
    # As a definition has it: the calibration is a table of the rig.
    inside = re.sub(r"(?m)^\[(\[?)(\w+)", r"[\1calibration.\2", "[calibration]\n" + calibration).replace("[calibration.calibration]", "[calibration]")
    model = re.sub(r"(?m)^\[(\[?)([\w.]+)", r"[\1model.\2", trunk_models()["raw5.toml"])
    chair = 'kind = "chair"\ntransient_sensors = ["w1", "w2", "w3", "w4"]\n'
    return {
        "floor.toml": 'kind = "floor"\n' + plate + sensors(corners) + stages + '[[stage]]\nid = "cop"\nestimator = "poly3"\n' + extras,
        "calibrated.toml": 'kind = "floor"\n' + plate + sensors(corners) + stages + '[[stage]]\nid = "cop"\n' + inside,
        "chair.toml": chair + plate + sensors(corners) + stages + "".join(f'[[stage]]\nid = "{stage}"\n' for stage in ("transient", "reach", "classify")) + "[model]\n" + model,
        "one.toml": 'kind = "floor"\n' + plate + sensors(corners[:1]) + '[[stage]]\nid = "guard"\n[acquire]\nlow_latency = true\n',
    }


def corrections() -> dict[str, str]:
    common = {"utc_ns": 1764000000000000000, "who": "local:anna"}
    subject = common | {"field": "subject", "old_value": "P071", "new_value": "P017", "reason": "typing error"}
    outcome = common | {"field": "outcome", "part": 1, "trial": 3, "attempt": 2, "old_value": "done", "new_value": "rejected", "reason": "talked"}
    deleted = common | {"field": "deleted", "old_value": "no", "new_value": "yes", "reason": "a test"}
    return {name: json.dumps({"session_id": "s1", "corrections": listed}) for name, listed in (
        ("none", []), ("subject", [subject]), ("all", [subject, outcome, deleted, common | {"field": "notes", "old_value": "", "new_value": "n", "reason": "r"}]))}


def label_patterns() -> dict[str, str]:
    return {
        "words": "[A-Za-z0-9(][a-z]*( ([a-z]+|[A-Z0-9]{1,5}))*\neyes closed T1",
        "counts": "(pre|post)-[0-9]{1,2}\npost-12",
        "slow": "(a*)*b\n" + 60 * "a",
        "odd": "[^a-c]\\.{2,}(|x)?\n.d..x",
        "large": "((a{20}){10}){10}\naa",
        "properties": "[^\\p{Z}]*( [^\\p{Lu}\\p{Z}]+|\\p{Lu}{1,5})*\n\u0434\u0438\u0442\u0438\u043d\u0430 OP",
    }


def configs() -> dict[str, str]:
    network = '[network]\ncontrol = "tcp://*:5555"\ndata = "tcp://*:5556"\n'
    realtime = '[log]\nlevel = "debug"\n[endpoints]\ncontrol = "ipc:///run/dtsd/control.sock"\ndata = "ipc:///run/dtsd/data.sock"\n[realtime]\nfifo_priority = 40\nlock_memory = false\ncpus = [0]\n[devices]\nallow_exec = true\n'
    storage = '[storage]\ndirectory = "state"\nrefuse_below_min = 5.0\nwarn_below_min = 30\nresume_within_min = 10.0\nstop_below_mib = 1.0\n[protocols]\ndirectory = "protocols"\n'
    privacy = '[privacy]\nlabel_pattern = "[a-z]+( [a-z0-9]{1,8})*"\nlabel_hint = "small letters"\n'
    return {
        "dtsd.toml": shipped("dtsd.toml"),
        "clinic.toml": shipped("dtsd-clinic.toml"),
        "daq.toml": shipped("dtsd-daq.toml"),
        "everything.toml": network + realtime + storage + privacy,
        "empty.toml": "",
    }


def keys() -> dict[str, str]:
    pair = 'public_key = "' + "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7" + '"\nsecret_key = "' + "JTKVSB%%)wK0E.X)V>+}o?pNmC{O&4W4b!Ni{Lh6" + '"\n'
    client = '[[client]]\nname = "{}"\nrole = "{}"\npublic_key = "{}"\ncreated = "2026-01-31T12:00:00Z"\n'
    return {
        "server.toml": pair,
        "clients.toml": client.format("anna", "viewer", KEY_ZERO) + client.format("otto.2", "engineer", "1" * 40),
        "client.toml": f'name = "anna"\n{pair}server_public_key = "{KEY_ZERO}"\ncontrol = "tcp://clinic-7:5555"\ndata = "tcp://clinic-7:5556"\n',
    }


def users() -> dict[str, str]:
    return {
        "users": f"# the clinic\nanna:operator:{HASH}\n\notto:engineer:{HASH}\n",
        "no-end": f"vera:viewer:{HASH}",
        "login.json": '{"user": "anna", "password": "correct horse battery staple"}',
        "unicode.json": '{"user": "anna", "password": "\\u00e4\\ud83d\\ude00 long enough"}',
    }


def http() -> dict[str, str]:
    get = "GET {} HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n{}\r\n"
    upgrade = ("Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
               "Sec-WebSocket-Protocol: dts.v1\r\nOrigin: http://127.0.0.1:8080\r\nCookie: a=b; dts_token=abc\r\n")
    return {
        "page": get.format("/", ""),
        "query": get.format("/api/sessions/20261121T144525Z-floor-1/export/xdf/2?a=1&b=%c3%a4+x", "Accept: */*\r\n"),
        "report": get.format("/api/sessions/s1/report/trial-01.html", ""),
        "upgrade": get.format("/ws", upgrade),
        "login": 'POST /api/login HTTP/1.1\r\nHost: clinic.example\r\nOrigin: http://clinic.example\r\nContent-Length: 32\r\n\r\n{"user":"anna","password":"abc"}',
        "chunked": "POST /api/logout HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n3;x=y\r\nabc\r\n0\r\n\r\n",
        "target": "/a%20b/%2e%2e/c?x=%25",
        "host": "[::1]:8080",
    }


def control(module) -> dict[str, bytes]:
    def heard(peer: int, *commands: dict) -> bytes:
        out = bytes([peer])
        for number, command in enumerate(commands):
            out += piece(module.Request(request_id=f"r{number}", **command).SerializeToString())
        return out

    seeds = {f"look-{name}": heard(1, {name: {}}) for name in ("status", "list_rigs", "get_devices", "list_sessions", "show_session", "list_protocols")}
    start = {"start_session": {"rig": "floor", "protocol": "reach", "subject": "s01", "fields": {"arm_length_cm": "71"}}}
    seeds["session"] = heard(2, {"start_session": {"rig": "floor", "duration_s": 60.0}}, {"mark": {"text": "now"}}, {"stop_session": {}})
    seeds["trials"] = heard(0, start, {"trial": {"action": 1}}, {"trial": {"action": 3}}, {"stop_session": {"is_abort": True, "reason": "no"}})
    seeds["tare"] = heard(2, {"tare": {"rig": "floor"}}, {"test_device": {"rig": "floor"}})
    seeds["keys"] = heard(3, {"list_keys": {}}, {"add_key": {"name": "zoe", "role": 1, "public_key": KEY_ZERO}}, {"revoke_key": {"name": "zoe"}})
    seeds["audit"] = heard(0, {"get_audit": {"limit": 3}}, {"resume_session": {"session_id": "x"}}, {"list_sessions": {"rig": "floor", "limit": 5}})
    seeds["corrections"] = heard(2, start, {"stop_session": {}}, {"correct_session": {"session_id": "x", "label": "a", "trial": 1, "outcome": "done", "reason": "r"}},
                                 {"delete_session": {"session_id": "x", "reason": "r"}}, {"list_sessions": {"deleted": True}})
    seeds["erasure"] = heard(3, start, {"stop_session": {}}, {"list_subjects": {}}, {"show_subject": {"subject": "s01"}}, {"erase_subject": {"subject": "s01"}})
    seeds["revoked"] = heard(4, {"status": {}}, {"mark": {"text": "x"}})
    return seeds


def bus(control_module, stream) -> dict[str, bytes]:
    rate = {"numerator": 100, "denominator": 1}
    channels = [{"name": "x_mm", "unit": "mm"}, {"name": "y_mm", "unit": "mm"}]
    rig = {"name": "floor", "kind": "floor", "streams": [{"name": "cop", "rate": rate, "channels": channels}]}
    status = control_module.StatusSnapshot(instance_id=7, boot_id="this-boot", rigs=[{"rig": rig}], disk={"state": 1})
    block = stream.StreamBlock(instance_id=7, rate=rate, scan_count=2, channel_count=2, values=[1.0, 2.0, 3.0, 4.0], quality=b"\0\0", sequence=1)
    later = stream.StreamBlock(instance_id=8, rate=rate, scan_count=1, channel_count=2, values=[1.0, 2.0], quality=b"\0\1", first_scan=9)
    gap = stream.Event(instance_id=7, gap={})
    said = {1: status, 2: block}

    def heard(*messages: tuple) -> bytes:
        return b"".join(bytes([topic]) + piece(message.SerializeToString()) for topic, message in messages)

    answers = [{"rigs": {"rigs": [rig]}}, {"error": {"code": 5, "what": "x"}}, {"session": {"session_id": "s", "trial": {"phase": 1}}},
               {"sessions": {"sessions": [{"session_id": "s", "parts": [{"state": 1, "duration_s": 1.5}]}]}},
               {"subject": {"about": {"subject": "s"}, "sessions": [{"session_id": "s", "corrections": [{"field": "label"}]}]}}, {"erased": {"left": ["x"]}},
               {"protocols": {"protocols": [{"name": "free", "fields": [{"name": "a", "maximum": 2.0}]}]}}, {"tare": {"baseline": [0.1]}}]
    return {
        "in-order": heard(*said.items(), (5, gap)),
        "held": heard((2, block), (5, gap), (1, status), (2, block)),
        "restarted": heard(*said.items(), (2, later), (1, status)),
        "answers": heard(*((0, control_module.Response(request_id="r", **answer)) for answer in answers)),
    }


def browser(gateway) -> dict[str, bytes]:
    def said(role: int, *steps) -> bytes:
        out = bytes([role])
        for step in steps:
            kind, message = (0, step) if isinstance(step, bytes) else (2, step.SerializeToString() if step else b"")
            out += b"\1" if step is None else bytes([kind]) + piece(message)
        return out

    message = gateway.FromBrowser
    wish = message(subscribe={"topics": ["floor/", ""], "frames_per_second": 30.0})
    return {
        "subscribe": said(1, wish, b"block", b"event", None, message(painted={"frame": 1})),
        "clock": said(0, message(clock_probe={"browser_ms": 12.5}), message(subscribe={})),
        "viewer": said(1, message(request={"request_id": "a", "status": {}}), message(request={"request_id": "b", "mark": {"text": "x"}})),
        "engineer": said(3, message(request={"request_id": "a", "get_audit": {}}), None, message(request={"request_id": "\u00e4" * 40})),
    }


def daqs() -> dict[str, bytes]:
    many = bytes([0] * 40 + [210, 3, 0xFF] + [0] * 40 + [255])
    return {
        "u6": b"\0" + piece(b"channels=0,1,2&marker=15&marker_v=0") + many,
        "u6-digital": b"\0" + piece(b"channels=0,1&digital=1&range_v=1") + b"\0" * 60 + b"\xf0\x20\0" + b"\xff" * 32,
        "1608fs": b"\1" + piece(b"channels=0,1,2,3&range_v=5") + many,
        "1208fs": b"\2" + piece(b"channels=0,7") + b"\0" * 30 + b"\xe0\1" + many,
        "usb-204": b"\3" + piece(b"") + b"\0" * 50 + b"\xf0\0\4\0\1\2\3\4",
        "1608g": b"\4" + piece(b"channels=0,1,15&range_v=10") + many,
    }


def boards() -> dict[str, bytes]:
    def payload(content: bytes) -> bytes:
        return b"\1" + piece(content)

    def wait(*tens_of_ms: int) -> bytes:
        return b"".join(bytes([6, time]) for time in tens_of_ms)

    def scans(counter: int, channels: int) -> bytes:
        return payload(bytes([3, 2]) + struct.pack("<II", counter, 0) + b"\3" + b"\x10\0" * (3 * channels))

    descriptor = bytes([1, 1, 4, 10]) + struct.pack("<III", 100, 1, 1_000_000) + bytes([11]) + b"\2S1\3Uno\0011"
    channel = bytes([2, 0, 0]) + struct.pack("<hhff", 0, 1023, 0.004, 0.0) + b"\2a0\1V"
    lost = bytes([4, 2]) + struct.pack("<IBI", 50, 1, 7)
    seeds = {
        "frames": b"\0" + piece(b"") + b"".join(scans(3 * i, 4) + wait(3) for i in range(4)) + payload(descriptor) + payload(channel)
        + payload(lost) + payload(b"\5hello") + b"\2" + wait(20, 20, 20),
        "faults": b"\0" + piece(b"") + wait(5) + b"\3\x28" + wait(30, 30) + b"\3\0" + wait(10) + b"\2" + wait(30) + b"\4\x09" + wait(10, 200)
        + b"\7\0" + wait(200) + b"\7\1" + wait(9),
        "marker": b"\1" + piece(b"") + wait(5) + scans(0, 2) + wait(5, 5),
    }
    for form, (name, first) in enumerate({"lines": b"", "counted16": b"7,", "counted": b"9,", "timed": b"1000,"}.items()):
        lines = b"x\n" + first + b"1,2,3,4\n" + first + b"1 2 3 4*00\r\n\n"
        seeds[name] = bytes([form + 2]) + piece(b"") + wait(5) + b"\0" + piece(lines) + wait(20) + b"\3\x1e" + wait(20) + b"\3\0\2" + wait(40, 100)
        seeds[name] += b"\7\0" + wait(9)
    return seeds


def u6_streams() -> dict[str, bytes]:
    def packet(samples: list[int], error: int = 0, discarded: int = 0) -> bytes:
        return bytes(6) + struct.pack("<IBB", discarded, 0, error) + struct.pack(f"<{len(samples)}H", *samples) + bytes(2)

    recovery = packet([1, 2, 3, 4], 59) + packet([5, 0xFFFF, 0xFFFF, 6], 60, 5) + packet([7, 8, 9, 10])
    slopes = b"".join(struct.pack("<q", round(value * 2**32)) for gain in range(4) for value in (3.1580578e-4 / 10**gain, 0.0))
    negative = b"".join(struct.pack("<q", round(value * 2**32)) for gain in range(4) for value in (-3.1580578e-4 / 10**gain, 33523.0))
    return {
        "sound": bytes([2, 3, 3, 255, 255]) + packet([1, 2, 3, 4]) + packet([5, 6, 7, 8]),
        "cut": bytes([2, 3, 3, 0, 6]) + packet([1, 2, 3, 4]) + packet([5, 6, 7, 8]),
        "recovery": bytes([1, 3, 3, 1, 10]) + recovery,
        "recovery-across": bytes([5, 3, 3, 3, 255]) + packet([1, 2, 3, 4]) + packet([5, 6, 0xFFFF, 0xFFFF], 60, 9) + packet([0xFFFF] * 4) + packet([1, 2, 3, 4]),
        "unsealed": bytes([0, 0, 0, 9, 9]) + packet([1]),
        "calibration": bytes([0, 0, 0, 9, 9]) + slopes + negative,
    }


def zmtp() -> dict[str, bytes]:
    greeting = b"\xff" + bytes(8) + b"\x7f\3\0NULL" + bytes(48)

    def command(name: bytes, data: bytes) -> bytes:
        return bytes([4, 1 + len(name) + len(data), len(name)]) + name + data

    ready = command(b"READY", b"\x08Identity" + bytes(4) + b"\x0bSocket-Type" + struct.pack(">I", 4) + b"XPUB")
    message = b"\1\x09floor/cop" + b"\2" + struct.pack(">Q", 300) + bytes(300)
    return {
        "handshake": greeting + ready,
        "messages": greeting + ready + message + message,
        "ping": greeting + ready + command(b"PING", b"\0\x0acontext") + message,
        "error": greeting + command(b"ERROR", b"\3bad"),
        "cut": greeting + ready + message[:20],
    }


def fleet(module) -> dict[str, bytes]:
    sum_ = bytes(range(32))
    receipt = {"clinic": "kent", "sha256": sum_, "bytes": 5, "stored_utc_ns": 1, "hub": "hub-1"}
    session = {
        "session_id": "20261121T144525Z-floor-1", "revision": 3, "rig": "floor", "protocol": "romberg", "subject": "P017", "state": "complete", "started_utc_ns": 1,
        "ended_utc_ns": 2, "planned_trials": 1, "label": "first", "notes": "a\nb", "fields": {"arm_length_cm": "71"},
        "parts": [{"part": 1, "state": 2, "sha256": sum_, "recorded_sha256": sum_, "bytes": 5, "scans": 7, "duration_s": 1.5, "valid_trials": 1}],
        "trials": [{"part": 1, "trial": 1, "attempt": 1, "condition": "eyes-open", "outcome": "done", "recorded_outcome": "redone", "fault": 2}],
        "results": [{"name": "MVELO", "value": 8.4, "unit": "mm/s"}],
    }
    rig = {"rig": "floor", "kind": "floor", "device": 3, "nominal_rate_hz": 100.0, "measured_rate_hz": 99.9, "session": 4, "streams": ["cop", "sway"]}
    beat = {"utc_ns": 1, "forwarder_version": "0.2.0", "has_daemon": True, "rigs": [rig], "disk": {"state": 1, "free_bytes": 9}, "backlog": {"files": 1, "bytes": 5}}
    kinds = [
        ("offer", 0, module.UploadOffer(sha256=sum_, bytes=5, session_id="s1", part=1)),
        ("chunk", 1, module.UploadChunk(sha256=sum_, offset=3, data=b"abc")),
        ("commit", 2, module.UploadCommit(sha256=sum_)),
        ("stored", 3, module.UploadAnswer(stored=receipt)),
        ("upload", 3, module.UploadAnswer(upload={"worker": "hub-1", "have": 3})),
        ("later", 3, module.UploadAnswer(later={"reason": "full", "wait_s": 300})),
        ("refusal", 3, module.UploadAnswer(refusal={"reason": "no"})),
        ("session", 4, module.FleetSession(**session)),
        ("facts-answer", 5, module.FactsAnswer(revision=3)),
        ("erase", 6, module.EraseSession(session_id="s1")),
        ("erase-answer", 7, module.EraseAnswer(files=2)),
        ("beat", 8, module.Beat(**beat)),
        ("beat-answer", 9, module.BeatAnswer(utc_ns=1, hub="hub-1", audit_head=sum_)),
        ("live-request", 10, module.LiveRequest(topics=["floor/cop"], who="anna")),
        ("live-answer", 11, module.LiveAnswer(lease_s=10)),
    ]
    seeds = {name: bytes([kind]) + message.SerializeToString() for name, kind, message in kinds}
    seeds["subject-chunk"] = b"\x0cdts.v1.kent.up.hub-1.chunk"
    seeds["subject-live"] = b"\x0cdts.v1.kent.live.floor.cop"
    return seeds


def link() -> dict[str, bytes]:
    """The first byte is the length of a piece, less one."""
    info = b'INFO {"server_id":"N","version":"2.9.10","proto":1,"headers":true,"auth_required":true,"max_payload":1048576,"nonce":"bm9uY2U"} \r\n'
    message = b"MSG dts.v1.kent.down.live 7 _INBOX.kent.1 5\r\na\r\nbc\r\n"
    silent = b"HMSG _INBOX.kent.2 9 16 16\r\nNATS/1.0 503\r\n\r\n\r\n"
    return {
        "greeting": b"\0" + info + b"PONG\r\n",
        "letters": b"\x06" + message + b"PING\r\n+OK\r\nMSG a 1 0\r\n\r\n" + silent,
        "headers": b"\x10HMSG a.b 1 r 18 20\r\nNATS/1.0\r\nA: b\r\n\r\nhi\r\n" + silent,
        "errors": b"\xff-ERR 'Permissions Violation for Publish to \"a\"'\r\n-ERR 'Authorization Violation'\r\n",
        "info": b"\1" + b'{"max_payload":18446744073709551615,"nonce":5}',
        "cut": b"\3" + message[:-4],
        "wrong": b"\4MSG a 1 8388609\r\nHMSG a 1 5 4\r\nGET / HTTP/1.1\r\n",
    }


def write(folder: pathlib.Path, seeds: dict) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in seeds.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def main() -> None:
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "corpus"
    control_module, gateway, stream, fleet_module = messages()
    protocols = {path.name: without_comments(path.read_text()) for path in (CONFIG / "protocols").glob("*.toml")}
    for target, seeds in {
        "sensor_curve": sensor_curves(), "force_plate": force_plates(), "force": force_texts(), "cop_calibration": cop_calibrations(), "trunk_model": trunk_models(), "protocol": protocols, "rig": rigs(),
        "config": configs(), "corrections": corrections(), "label_pattern": label_patterns(), "keys": keys(), "users": users(), "http": http(), "control": control(control_module), "bus": bus(control_module, stream),
        "browser": browser(gateway), "daq": daqs(), "u6": u6_streams(), "serial": boards(), "zmtp": zmtp(), "fleet": fleet(fleet_module), "link": link(),
    }.items():
        write(folder / target, seeds)


if __name__ == "__main__":
    main()
