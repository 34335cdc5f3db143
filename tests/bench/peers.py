#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""dtsd beside the ways a user could take instead: plain libzmq with protobuf, and a shared-memory ring as the floor.

Needs the peer benchmarks, whose driver and programs it uses where they lie (--peers-dir, else the environment variable
DTS_PEERS_DIR; without either nothing is compared), and peer_dtsd of this build. Every process runs at SCHED_FIFO 50 and in a network
namespace of its own when that is permitted. Compare within one table only, as ratios. --extra adds peers from a JSON file: {"name": {"cmd": ["program", "argument"]}}.
"""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMESPACE_MARK = 'DTS_BENCH_NAMESPACE'
TCP = 'tcp://127.0.0.1:5601'


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--program', default=str(ROOT / 'build/release/bench/peer_dtsd'), help='peer_dtsd (default: %(default)s)')
    parser.add_argument('--peers-dir', default=os.environ.get('DTS_PEERS_DIR', ''), help='folder of the peer benchmarks (default: DTS_PEERS_DIR)')
    parser.add_argument('--extra', help='JSON file with further peers; liblsl, if there, must be called lsl')
    parser.add_argument('--quick', action='store_true', help='one short round: shows that everything works, the figures are rough')
    parser.add_argument('--rounds', type=int, default=3)
    parser.add_argument('--seconds', type=float, default=4.0)
    parser.add_argument('--only', help='comma-separated peers of the latency table; empty: no such table')
    parser.add_argument('--stall-rates', default='1500,20000', help='scans/s of the stall test; empty: none')
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.rounds, arguments.seconds, arguments.stall_rates = 1, 1.5, '1500'
    return arguments


def enter_namespace():
    """Starts this program again inside a namespace that has the loopback interface only; goes on outside when that is refused."""
    if os.environ.get(NAMESPACE_MARK) or not shutil.which('unshare'):
        return
    if subprocess.run(['unshare', '-n', 'true'], stderr=subprocess.DEVNULL, check=False).returncode == 0:
        os.environ[NAMESPACE_MARK] = '1'
        os.execvp('unshare', ['unshare', '-n', sys.executable, *sys.argv])


def raise_loopback():
    """What `ip link set lo up` does, without needing that program."""
    import fcntl
    import socket
    import struct
    set_flags, up_and_running = 0x8914, 0x1 | 0x40
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, set_flags, struct.pack('16sh', b'lo', up_and_running))


def build_peers(source, directory):
    for command in (['cmake', '-S', source, '-B', directory, '-DCMAKE_BUILD_TYPE=Release'],
                    ['cmake', '--build', directory, '--target', 'peer_zmq', 'peer_floor', '-j', str(os.cpu_count())]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f'peers.py: {" ".join(command)} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}')


def own_peers(program, directory):
    """`_one_core`: sample threads, publisher and libzmq's thread of the daemon on core 1. `_floor`: four stages, five streams."""
    endpoints = {'tcp': TCP, 'ipc': f'ipc://{directory}/data.sock'}
    one_core = ['cpu=1', 'zmq_cpu=1'] if os.cpu_count() > 1 else []
    peers = {}
    for kind, endpoint in endpoints.items():
        peers[f'dtsd_{kind}'] = [program, f'ep={endpoint}']
        peers[f'dtsd_{kind}_one_core'] = [program, f'ep={endpoint}', *one_core]
    peers['dtsd_floor'] = [program, f'ep={TCP}', 'load=floor']
    peers['dtsd_floor_one_core'] = [program, f'ep={TCP}', 'load=floor', *one_core]
    peers['dtsd_latest'] = [program, f'ep={TCP}', 'mode=latest']
    return {name: {'cmd': command} for name, command in peers.items()}


def load_average():
    return os.getloadavg()[0]


class Table:
    """Interleaved rounds of one message size; medians of each figure."""

    def __init__(self, bench, names, rate, chunk, seconds, prefix):
        self.bench, self.names, self.rate, self.chunk, self.seconds, self.prefix = bench, names, rate, chunk, seconds, prefix
        self.runs = {name: [] for name in names}
        self.load = load_average()

    def run_round(self, number):
        shift = number % len(self.names)
        for name in self.names[shift:] + self.names[:shift]:
            run = self.bench.run(name, self.rate, self.chunk, 1, self.seconds, pre=self.prefix)
            if run['prod'] and run['cons'][0]:
                self.runs[name].append(run)
            else:
                print(f'peers.py: a run of {name} failed', file=sys.stderr)

    def median(self, name, side, key):
        values = [(run['prod'] if side == 'prod' else run['cons'][0]).get(key, 0) for run in self.runs[name]]
        return statistics.median(values) if values else float('nan')

    def total(self, name, key):
        return sum(run['cons'][0][key] for run in self.runs[name])

    def row(self, name):
        cons = {key: self.median(name, 'cons', key) for key in ('p50', 'p99', 'p999', 'max', 'cpu_pct', 'cs_per_msg')}
        prod = {key: self.median(name, 'prod', key) for key in ('cpu_pct', 'cs_per_msg', 'push_p50', 'age_at_push_p50')}
        p50s = [run['cons'][0]['p50'] for run in self.runs[name]] or [float('nan')]
        age = f'{prod["age_at_push_p50"]:.0f}' if name.startswith('dtsd') else ''
        cells = [name, f'{cons["p50"]:.0f} ({min(p50s):.0f}-{max(p50s):.0f})', *(f'{cons[key]:.0f}' for key in ('p99', 'p999', 'max')),
                 str(self.total(name, 'lost')), f'{prod["cpu_pct"]:.1f}', f'{cons["cpu_pct"]:.1f}', f'{prod["cs_per_msg"]:.2f}',
                 f'{cons["cs_per_msg"]:.2f}', age]
        for base in ('zmq_' + ('ipc' if '_ipc' in name else 'tcp'), 'shm', 'lsl'):
            if base in self.names and self.runs[base]:
                cells.append(' / '.join(f'{cons[key] / self.median(base, "cons", key):.2f}' for key in ('p50', 'p99')) +
                             f' / {prod["cpu_pct"] / self.median(base, "prod", "cpu_pct"):.2f}')
        return '| ' + ' | '.join(cells) + ' |'

    def show(self):
        bases = ['zmq (same transport)', 'shm'] + (['lsl'] if 'lsl' in self.names else [])
        head = ['peer', 'p50 (spread)', 'p99', 'p99.9', 'max', 'lost', 'CPU producer', 'CPU consumer', 'switches producer',
                'switches consumer', 'age at send'] + [f'p50 / p99 / CPU to {base}' for base in bases]
        print(f'\n### {self.rate} scans/s x 16 channels, {self.chunk} scan(s) a message, us and % (load average {self.load:.1f})\n')
        print('| ' + ' | '.join(head) + ' |\n|' + '---|' * len(head))
        for name in self.names:
            print(self.row(name))
        sys.stdout.flush()


def show_stalls(bench, names, rates, seconds, prefix):
    """One of two subscribers is stopped (SIGSTOP) in the middle and continued; the row without a stop is for comparison."""
    print(f'\n### One of two subscribers stopped for {seconds} s, one scan a message (load average {load_average():.1f})\n')
    head = ['peer', 'scans/s', 'longest send call, us (without a stop)', 'producer kB before / most / end', 'healthy: lost', 'healthy: p99',
            'stopped: lost, as counted from outside', 'stopped: lost, as told', 'told exactly?', 'age of its first data, ms']
    print('| ' + ' | '.join(head) + ' |\n|' + '---|' * len(head))
    for rate in rates:
        for name in names:
            # A consumer gives up when nothing comes for idle_ms; a stopped one finds that this time has passed when it continues.
            common = {'secs': seconds + 7, 'idle_ms': 1000 * (seconds + 5), 'pre': prefix}
            calm = bench.run(name, rate, 1, 2, **common)
            run = bench.run(name, rate, 1, 2, stall={'after': 2, 'for': seconds, 'step': 1}, **common)
            if not run['prod'] or None in run['cons'] or not calm['prod']:
                print(f'| {name} | {rate} | a process failed |')
                continue
            healthy, stopped = run['cons']
            memory = [sample[1] for sample in run['trace']]
            told = str(stopped['told_lost']) if 'told_lost' in stopped else 'nothing'
            exact = ('yes' if stopped['told_exact'] and stopped['told_lost'] == stopped['lost'] else 'no') if 'told_lost' in stopped else ''
            age = f'{stopped["age_after_pause_ms"]:.1f}' if 'age_after_pause_ms' in stopped else 'not told'
            print('| ' + ' | '.join([name, str(rate), f'{run["prod"]["push_max"]:.0f} ({calm["prod"]["push_max"]:.0f})',
                                     f'{memory[0]} / {max(memory)} / {memory[-1]}', str(healthy['lost']), f'{healthy["p99"]:.0f}',
                                     str(stopped['lost']), told, exact, age]) + ' |', flush=True)


def main():
    arguments = parse_arguments()
    if not os.path.isdir(arguments.peers_dir):
        print(f'peers.py: skipped: no peer benchmarks in "{arguments.peers_dir}": give --peers-dir or DTS_PEERS_DIR')
        return
    if not os.access(arguments.program, os.X_OK):
        sys.exit(f'peers.py: {arguments.program} is missing; build target peer_dtsd or give --program')
    enter_namespace()
    if os.environ.get(NAMESPACE_MARK):
        raise_loopback()
    has_fifo = subprocess.run(['chrt', '-f', '50', 'true'], stderr=subprocess.DEVNULL, check=False).returncode == 0
    prefix = ('chrt', '-f', '50') if has_fifo else ()
    with tempfile.TemporaryDirectory(prefix='dts-peers-') as directory:
        build_peers(arguments.peers_dir, directory + '/build')
        peers = own_peers(os.path.abspath(arguments.program), directory)
        names = ['shm', 'zmq_tcp', 'zmq_ipc', 'dtsd_tcp', 'dtsd_ipc', 'dtsd_tcp_one_core', 'dtsd_ipc_one_core', 'dtsd_floor',
                 'dtsd_floor_one_core']
        if arguments.extra:
            with open(arguments.extra, encoding='utf-8') as file:
                extra = json.load(file)
            peers.update(extra)
            names += list(extra)
        if arguments.only is not None:
            names = [name for name in arguments.only.split(',') if name]
        with open(directory + '/peers.json', 'w', encoding='utf-8') as file:
            json.dump(peers, file)
        os.environ.update(BENCH_PEERS=directory + '/peers.json', BENCH_BUILD=directory + '/build')
        sys.dont_write_bytecode = True
        sys.path.insert(0, arguments.peers_dir)
        import bench  # reads the environment when it is imported

        print(f'## peers\n\nEvery process: {"SCHED_FIFO 50" if has_fifo else "default scheduling"}; network: '
              f'{"a namespace of its own" if os.environ.get(NAMESPACE_MARK) else "the host"}; {arguments.rounds} interleaved rounds of '
              f'{arguments.seconds} s, medians.\ndtsd: the whole daemon (device, ring, pipeline, ring, publisher), its threads at 50 to 47; '
              'stage guard and one stream,\nfloor: four stages and five streams. age at send: of the newest scan when the publisher sends it.')
        for chunk in (1, 8) if names else ():
            table = Table(bench, names, 1500, chunk, arguments.seconds, prefix)
            for number in range(arguments.rounds):
                table.run_round(number)
            table.show()
        rates = [int(rate) for rate in arguments.stall_rates.split(',') if rate]
        if rates:
            show_stalls(bench, ['zmq_tcp', 'shm', 'dtsd_tcp', 'dtsd_ipc', 'dtsd_latest'], rates, 3 if arguments.quick else 10, prefix)


main()
