#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares dtsd with the ways a user could take instead: liblsl, plain libzmq with protobuf, and a shared-memory ring as the floor.

Prints the tables of each measurement, then one table with the goals of the fast path. Needs the programs of the peer benchmarks, which it
builds from --peers-dir (or DTS_PEERS_DIR), and peer_dtsd and daemon_bench of this build. Every process runs at SCHED_FIFO 50 (see
--scheduling) and in a network namespace of its own if that is permitted; only the throughput runs at nice -15. --extra adds peers from a JSON file:
{"lsl": {"cmd": ["program", "argument"]}}; the goals relative to liblsl need a peer of the name lsl.
"""
import argparse
import collections
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMESPACE_MARK = 'DTS_BENCH_NAMESPACE'
RATE_HZ = 1500
BLOCK_SCANS = 30  # 20 ms
PARTS = ('latency', 'throughput', 'memory', 'calls', 'stops', 'turns', 'demo')


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--bin', default=str(ROOT / 'build/release/bench'), help='folder of peer_dtsd and daemon_bench (default: %(default)s)')
    parser.add_argument('--peers-dir', default=os.environ.get('DTS_PEERS_DIR', ''), help='folder of the peer benchmarks (default: DTS_PEERS_DIR)')
    parser.add_argument('--extra', help='JSON file with further peers')
    parser.add_argument('--before', help='peer_dtsd of an older build, measured in the same rounds')
    parser.add_argument('--before-dtsd', help='dtsd of an older build, for the demo')
    parser.add_argument('--quick', action='store_true', help='short measurements: shows that everything works, the values are rough')
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--scheduling', choices=('fifo', 'ordinary'), default='fifo',
                        help='fifo: SCHED_FIFO 50 if permitted; ordinary: as the shell does (default: %(default)s)')
    parser.add_argument('--seconds', type=float, default=4.0, help='length of a latency measurement')
    parser.add_argument('--turn-seconds', type=float, default=600.0, help='length of the search for the longest turn (default: %(default)s)')
    parser.add_argument('--parts', default=','.join(PARTS), help='comma-separated measurements (default: %(default)s)')
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.rounds, arguments.seconds = 1, 0.7
    return arguments


def enter_namespace():
    """Starts this program again in a namespace that has only the loopback interface; returns if that is refused."""
    if os.environ.get(NAMESPACE_MARK) or not shutil.which('unshare'):
        return
    if subprocess.run(['unshare', '-n', 'true'], stderr=subprocess.DEVNULL, check=False).returncode == 0:
        os.environ[NAMESPACE_MARK] = '1'
        os.execvp('unshare', ['unshare', '-n', sys.executable, '-B', *sys.argv])


def raise_loopback():
    """Does what `ip link set lo up` does, without that program."""
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


def all_peers(arguments, directory):
    """Returns the peers by name: `cmd` is the producer, `client` the consumer if that is another command."""
    program = os.path.abspath(arguments.bin) + '/peer_dtsd'
    endpoint = f'ep=ipc://{directory}/data.sock'
    peers = {'shm': {'cmd': [directory + '/build/peer_floor', 'mode=shm']},
             'zmq': {'cmd': [directory + '/build/peer_zmq', f'ep=ipc://{directory}/zmq.sock']}}
    producers = {'dtsd': program} | ({'before': os.path.abspath(arguments.before)} if arguments.before else {})
    for name, producer in producers.items():
        for suffix, load in (('', []), ('_five', ['load=floor'])):
            peers[name + suffix] = {'cmd': [producer, endpoint, *load], 'client': [program, endpoint, *load]}
            peers[name + suffix + '_stock'] = {'cmd': [producer, endpoint, *load], 'client': [program, endpoint, *load, 'client=stock']}
        peers[name + '_latest'] = {'cmd': [producer, endpoint], 'client': [program, endpoint, 'mode=latest']}
    if arguments.extra:
        with open(arguments.extra, encoding='utf-8') as file:
            peers.update(json.load(file))
    return peers


class Child:
    """A producer or a consumer: prints a word when it is set up, and one line of JSON at the end."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.is_set_up, self.figures = threading.Event(), None
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stdout:
            if line.startswith('{'):
                self.figures = json.loads(line)
            else:
                self.is_set_up.set()
        self.is_set_up.set()

    def finish(self, until):
        try:
            self.process.wait(max(0.1, until - time.monotonic()))
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.reader.join()


Run = collections.namedtuple('Run', 'producer consumers')


class Bench:
    """Runs one producer with any number of consumers."""

    def __init__(self, peers, prefix):
        self.peers, self.prefix = peers, prefix

    def run(self, name, chunk, subscribers, seconds, rate=RATE_HZ, prefix=None, meanwhile=None, **options):
        """`meanwhile` is called with the children when the producer begins. Returns None if a process failed."""
        peer, prefix = self.peers[name], self.prefix if prefix is None else prefix
        options = dict(rate=rate, chunk=chunk, secs=seconds, nsub=subscribers, linger_ms=200, exit_ms=200) | options
        words = [f'{key}={value}' for key, value in options.items()]
        producer = Child([*prefix, *peer['cmd'], 'role=prod', *words])
        children = [producer]
        try:
            producer.is_set_up.wait(60)  # at the highest rates the buffers of a producer take gigabytes
            children += [Child([*prefix, *peer.get('client', peer['cmd']), 'role=cons', *words]) for _ in range(subscribers)]
            for child in children:
                child.is_set_up.wait(30)
            with contextlib.suppress(BrokenPipeError):
                producer.process.stdin.write('go\n')
                producer.process.stdin.flush()
                if meanwhile:
                    meanwhile(producer, children[1:])
        finally:
            until = time.monotonic() + 2 * seconds + 15
            for child in children:
                child.finish(until)
        if any(child.figures is None for child in children):
            print(f'peers.py: a run of {name} failed ({subscribers} subscribers, {rate} scans/s)', file=sys.stderr)
            return None
        return Run(producer.figures, [child.figures for child in children[1:]])


def print_table(title, head, rows):
    print(f'\n### {title} (load average {os.getloadavg()[0]:.1f})\n\n| ' + ' | '.join(head) + ' |\n|' + '---|' * len(head))
    for row in rows:
        print('| ' + ' | '.join(str(cell) for cell in row) + ' |')
    sys.stdout.flush()


class Goals:
    """The values that have a goal, and the table of them."""

    def __init__(self):
        self.rows = []

    def add(self, goal, limit, values, before=(), is_least=False, digits=2):
        """`values`: one of each round; empty if it was not measured. `before`: those of the older build."""
        def text(value):
            return f'{value:.{digits}f}'
        values = [value for value in values if value is not None]
        sign = '>=' if is_least else '<='
        if not values:
            self.rows.append((goal, f'{sign} {limit}', 'not measured', '', '', '', ''))
            return
        middle = statistics.median(values)
        is_met = middle >= limit if is_least else middle <= limit
        self.rows.append((goal, f'{sign} {limit}', text(middle), f'{text(min(values))} to {text(max(values))}', len(values),
                          'yes' if is_met else '**no**', median_text(before, digits)))

    def show(self):
        print_table('Goals: medians of the rounds; ratios within a round', ('figure', 'goal', 'median', 'range', 'rounds', 'met', 'before'), self.rows)


class Latency:
    """Interleaved rounds of all peers: latency, CPU and switches."""

    def __init__(self, bench, arguments):
        self.bench, self.arguments, peers = bench, arguments, bench.peers
        own = [name for name in ('dtsd', 'dtsd_stock', 'before', 'before_stock') if name in peers]
        five = [name for name in ('dtsd_five', 'dtsd_five_stock', 'before_five_stock') if name in peers]
        extra = [name for name in peers if not name.startswith(('dtsd', 'before', 'shm', 'zmq'))]
        self.cells = [(name, 1, 1) for name in ['shm', 'zmq', *extra, *own, *five]]
        self.cells += [(name, 1, count) for count in (4, 16) for name in [*extra, *own]]
        if not arguments.quick:
            self.cells += [(name, BLOCK_SCANS, 1) for name in ['shm', 'zmq', *extra, *own]]
        self.runs = {cell: [] for cell in self.cells}

    def measure(self):
        for number in range(self.arguments.rounds):
            shift = 3 * number % len(self.cells)
            for cell in self.cells[shift:] + self.cells[:shift]:
                name, chunk, subscribers = cell
                self.runs[cell].append(self.bench.run(name, chunk, subscribers, self.arguments.seconds))

    def values(self, cell, key):
        """Of each round: the producer's for its CPU and switches, else the median of the consumers."""
        def value(run):
            if run is None:
                return None
            if key.startswith('producer_'):
                return run.producer.get(key[len('producer_'):])
            return statistics.median(consumer[key] for consumer in run.consumers)
        return [value(run) for run in self.runs.get(cell, [])]

    def ratios(self, cell, base, key):
        pairs = zip(self.values(cell, key), self.values(base, key))
        return [value / other for value, other in pairs if value is not None and other]

    def show(self):
        keys = ('p50', 'p99', 'p999', 'max', 'producer_cpu_pct', 'cpu_pct', 'producer_cs_per_msg', 'cs_per_msg', 'producer_age_at_push_p50')
        head = ['peer', 'subscribers', 'scans a message', 'p50', 'p99', 'p99.9', 'max', 'CPU producer', 'CPU consumer', 'switches producer',
                'switches consumer', 'age at send', 'lost'] + [f'p50 / p99 / CPU to {base}' for base in ('lsl', 'shm')]
        rows = []
        for cell in self.cells:
            name, chunk, subscribers = cell
            medians = [median_text(self.values(cell, key), 2 if 'cs_per' in key else 1) for key in keys]
            lost = sum(consumer['lost'] for run in self.runs[cell] if run for consumer in run.consumers)
            bases = [' / '.join(median_text(self.ratios(cell, (base, chunk, subscribers), key), 2) for key in ('p50', 'p99', 'producer_cpu_pct'))
                     for base in ('lsl', 'shm')]
            rows.append([name, subscribers, chunk, *medians, lost, *bases])
        print_table(f'{RATE_HZ} scans/s x 16 channels, us and % of a core, {self.arguments.rounds} rounds of {self.arguments.seconds} s', head, rows)

    def add_goals(self, goals):
        def add(goal, limit, suffix, base, key, subscribers=1):
            ratios = [self.ratios((name + suffix, 1, subscribers), (base, 1, subscribers), key) for name in ('dtsd', 'before')]
            goals.add(goal, limit, *ratios)
        add('p50, stock client / liblsl, one stream', 0.80, '_stock', 'lsl', 'p50')
        add('p50, stock client / liblsl, five streams', 0.85, '_five_stock', 'lsl', 'p50')
        add('p50, own client / liblsl', 0.40, '', 'lsl', 'p50')
        add('p50, own client / shared-memory floor', 1.25, '', 'shm', 'p50')
        add('p99, own client / liblsl', 0.55, '', 'lsl', 'p99')
        for subscribers, limit in ((1, 0.45), (4, 0.30), (16, 0.25)):
            add(f'CPU with the pipeline, {subscribers} subscriber(s) / liblsl outlet', limit, '', 'lsl', 'producer_cpu_pct', subscribers)
        goals.add('context switches a scan', 1.1, *(self.values((name, 1, 1), 'producer_cs_per_msg') for name in ('dtsd', 'before')))


def median_text(values, digits):
    values = [value for value in values if value is not None]
    return f'{statistics.median(values):.{digits}f}' if values else ''


def is_loss_free(run):
    """The producer keeps its rate, nothing is lost, and the last scan is no older than 100 ms."""
    return bool(run) and run.producer['achieved'] >= 0.98 * run.producer['rate'] and all(
        consumer['lost'] == 0 and consumer['last'] < 100e3 for consumer in run.consumers)


def highest_rate(bench, name, subscribers, begin, is_quick):
    """Looks for a rate that works, from `begin` down; doubles it, then tries 1.41 times the best. Every rate has two attempts."""
    seconds, attempts, factor = (0.5, 1, 8) if is_quick else (1.5, 2, 2)

    def works(rate):
        options = {'tick_us': 1000, 'settle_ms': 300, 'idle_ms': 1500, 'hwm': 100000, 'buflen': 20}
        return rate <= 1e6 and any(
            is_loss_free(bench.run(name, 1, subscribers, seconds, int(rate), ('nice', '-n', '-15'), **options)) for _ in range(attempts))
    best = begin
    while not works(best):
        best /= 4
        if best < 500:
            return 0
    while works(factor * best):
        best *= factor
    return 1.41 * best if not is_quick and works(1.41 * best) else best


def measure_throughput(bench, goals, rounds, is_quick):
    names = [name for name in ('lsl', 'dtsd', 'dtsd_stock', 'before') if name in bench.peers]
    best = collections.defaultdict(list)
    for _ in range(rounds):
        for subscribers, begin in ((1, 25000), (4, 12500), (16, 3000)):
            for name in names:
                known = best[name, subscribers]
                # Later rounds begin below the first one's result, which saves the lower rates.
                known.append(highest_rate(bench, name, subscribers, known[0] / 2 if known and known[0] else begin, is_quick))
    rows = [[name] + [f'{statistics.median(best[name, count]) / 1000:.1f} k' for count in (1, 4, 16)] for name in names]
    print_table('Highest loss-free rate, one scan a message, by subscribers', ['peer', '1', '4', '16'], rows)
    for subscribers, limit in ((1, 16), (4, 30), (16, 45)):
        ratios = [[own / lsl for own, lsl in zip(best[name, subscribers], best['lsl', subscribers]) if lsl] for name in ('dtsd', 'before')]
        goals.add(f'loss-free single samples a second, {subscribers} subscriber(s) / liblsl', limit, *ratios, is_least=True, digits=0)


def anonymous_mb(pid):
    with open(f'/proc/{pid}/status', encoding='utf-8') as file:
        return int(re.search(r'RssAnon:\s*(\d+)', file.read()).group(1)) * 1024 / 1e6


@contextlib.contextmanager
def paused(consumers):
    for consumer in consumers:
        consumer.process.send_signal(signal.SIGSTOP)
    yield
    for consumer in consumers:
        consumer.process.send_signal(signal.SIGCONT)


def measure_memory(bench, goals, rounds, stopped_s):
    """The producer's memory with many subscribers, less that without any at the same moments."""
    count, reading_s = 32, 2
    megabytes = collections.defaultdict(lambda: ([], []))

    def samples(name, subscribers):
        taken = []

        def watch(producer, consumers):
            time.sleep(reading_s)
            taken.append(anonymous_mb(producer.process.pid))
            with paused(consumers):
                time.sleep(stopped_s)
                taken.append(anonymous_mb(producer.process.pid))
        run = bench.run(name, BLOCK_SCANS, subscribers, reading_s + stopped_s + 1, meanwhile=watch, idle_ms=1000 * (stopped_s + 5))
        return taken if run else None

    names = [name for name in ('lsl', 'dtsd', 'before') if name in bench.peers]
    for _ in range(rounds):
        for name in names:
            none, many = samples(name, 0), samples(name, count)
            for place in (0, 1) if none and many else ():
                megabytes[name][place].append((many[place] - none[place]) / count)
    rows = [[name, *(median_text(megabytes[name][place], 3) for place in (0, 1))] for name in names]
    print_table(f'MB in the producer for each of {count} subscribers, {RATE_HZ} scans/s in 20 ms blocks',
                ['peer', 'reading', f'stopped for {stopped_s} s'], rows)
    goals.add('memory a subscriber that reads, MB', 0.01, megabytes['dtsd'][0], megabytes['before'][0], digits=3)
    goals.add('memory a stopped subscriber, MB', 0.4, megabytes['dtsd'][1], megabytes['before'][1], digits=3)


def measure_calls(bench, goals, rounds, directory):
    """System calls by thread, of blocks of 20 ms with four subscribers."""
    if not shutil.which('strace'):
        print('\nSystem calls: skipped, strace is not installed (Debian package strace).')
        return
    traced_s, file = 2.0, directory + '/calls'
    names = [name for name in ('dtsd', 'zmq', 'lsl', 'before') if name in bench.peers]
    rows, per_block = [], collections.defaultdict(list)
    for number in range(rounds):
        for name in names:
            threads = {}

            def trace(producer, _consumers):
                time.sleep(1.0)
                tasks = pathlib.Path(f'/proc/{producer.process.pid}/task')
                threads.update({task.name: (task / 'comm').read_text().strip() for task in tasks.iterdir()})
                tracer = subprocess.Popen(['strace', '-f', '-q', '-o', file, '-p', str(producer.process.pid)], stderr=subprocess.DEVNULL)
                time.sleep(traced_s)
                tracer.send_signal(signal.SIGINT)
                tracer.wait()
            if not bench.run(name, BLOCK_SCANS, 4, traced_s + 2, meanwhile=trace):
                continue
            calls = collections.Counter()
            for line in pathlib.Path(file).read_text(encoding='utf-8', errors='replace').splitlines():
                if found := re.match(r'(\d+) +(\w+)\(', line):
                    # The main thread of peer_dtsd is the daemon's control thread.
                    calls[threads.get(found.group(1), '?'), found.group(2)] += 1
            blocks = traced_s * RATE_HZ / BLOCK_SCANS
            control = sum(count for (thread, _), count in calls.items() if thread in ('peer_dtsd', 'control')) / blocks
            per_block[name].append(calls.total() / blocks - control)
            if number == 0:
                text = ', '.join(f'{thread} {call} {count / blocks:.1f}' for (thread, call), count in calls.most_common(12))
                rows.append([name, f'{per_block[name][0]:.1f}', f'{control:.1f}', text])
    print_table('System calls a 20 ms block, four subscribers', ['producer', 'without the control thread', 'control thread', 'most frequent'], rows)
    goals.add('system calls a 20 ms block, 4 subscribers', 8, per_block['dtsd'], per_block['before'], digits=1)


def measure_stops(bench, goals, stops, seconds):
    """One of two subscribers is stopped again and again; what the other one and the producer notice, and how old its first data are."""
    rows = []
    others = ('shm', 'zmq', 'lsl', 'before') if stops > 1 else ()
    cells = [(name, 1) for name in (*others, 'dtsd') if name in bench.peers]
    cells += [(name, chunk) for chunk in (1, BLOCK_SCANS) for name in ('dtsd_latest', 'before_latest') if name in bench.peers]
    periods = {}
    for name, chunk in cells:
        def stop(_producer, consumers):
            time.sleep(2)
            for _ in range(stops):
                with paused(consumers[-1:]):
                    time.sleep(seconds)
                time.sleep(1.5)
        length = 3 + stops * (seconds + 1.5)
        # A consumer gives up if nothing arrives for idle_ms; a stopped one finds that this time has passed when it continues.
        run = bench.run(name, chunk, 2, length, meanwhile=stop, idle_ms=1000 * (seconds + 10))
        ages = []
        if run:
            healthy, stopped = run.consumers
            knows = 'told_lost' in stopped
            ages = [1e-3 * stopped['oldest_after_pause_us'] * RATE_HZ / chunk / 1000] if 'oldest_after_pause_us' in stopped else []
            exact = ('yes' if stopped['told_exact'] and stopped['told_lost'] == stopped['lost'] else 'no') if knows else ''
            rows.append([name, chunk, f'{run.producer["push_max"]:.0f}', healthy['lost'], f'{healthy["p99"]:.0f}', stopped['lost'],
                         stopped['told_lost'] if knows else 'nothing', exact,
                         f'{stopped["oldest_after_pause_us"] / 1000:.1f}' if ages else '', f'{ages[0]:.2f}' if ages else ''])
        periods[name, chunk] = ages
    head = ['peer', 'scans a message', 'longest send call, us', 'healthy: lost', 'healthy: p99, us', 'stopped: lost', 'stopped: reported',
            'exactly?', 'oldest first data, ms', '... in periods']
    print_table(f'One of two subscribers stopped {stops} times for {seconds} s, {RATE_HZ} scans/s', head, rows)
    for chunk in (1, BLOCK_SCANS):
        goals.add(f'oldest first data after {stops} stops, mode latest, {chunk} scan(s) a message, periods', 2, periods['dtsd_latest', chunk],
                  periods.get(('before_latest', chunk), ()))


@contextlib.contextmanager
def busy_cores(directory):
    load = subprocess.Popen(['stress-ng', '--cpu', '0', '--vm', '1', '--vm-bytes', '256M', '--temp-path', directory],
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        load.terminate()
        load.wait()


def measure_turns(bench, seconds):
    """The longest turn of the rig's thread, from one read of the device to the next, while every core is busy."""
    if not shutil.which('stress-ng'):
        print('\nLongest turns: skipped, stress-ng is not installed (Debian package stress-ng).')
        return
    rows = []
    with tempfile.TemporaryDirectory() as directory, busy_cores(directory):
        for name, chunk, part in (('dtsd_five', 1, 0.8), ('dtsd_five', BLOCK_SCANS, 0.2)):
            run = bench.run(name, chunk, 4, part * seconds)
            if run:
                lost = sum(consumer['lost'] for consumer in run.consumers)
                rows.append([chunk, run.producer['msgs'], *(f'{run.producer[key]:.0f}' for key in ('turn_max', 'push_max', 'late_max')), lost])
    print_table(f'Longest turns of the rig thread, five streams, four subscribers, {seconds:.0f} s beside stress-ng on every core, us',
                ['scans a block', 'turns', 'longest turn', 'longest send call', 'latest start of a turn', 'lost'], rows)


def measure_demo(arguments, goals):
    command = [arguments.bin + '/daemon_bench', '--part', 'demo', '--rounds', str(arguments.rounds), '--seconds', '3' if arguments.quick else '20']
    if arguments.before_dtsd:
        command += ['--before', arguments.before_dtsd]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    print('\n' + done.stdout.strip(), flush=True)
    rows = re.findall(r'^\| (this build|before) \| ([\d.]+) \|.* ([\d.]+) \|$', done.stdout, re.MULTILINE)
    values = {build: ([float(cpu)], simulators) for build, cpu, simulators in rows}
    own, simulators = values.get('this build', ([], '?'))
    goals.add(f'idle demo, two simulated rigs, % of a core (the simulators alone: {simulators})', 1.0, own, *values.get('before', ())[:1])


def main():
    arguments = parse_arguments()
    if not os.path.isdir(arguments.peers_dir):
        print(f'peers.py: skipped: no peer benchmarks in "{arguments.peers_dir}": give --peers-dir or DTS_PEERS_DIR')
        return
    for program in ('peer_dtsd', 'daemon_bench'):
        if not os.access(f'{arguments.bin}/{program}', os.X_OK):
            sys.exit(f'peers.py: {arguments.bin}/{program} is missing; build it or give --bin')
    enter_namespace()
    if os.environ.get(NAMESPACE_MARK):
        raise_loopback()
    has_fifo = arguments.scheduling == 'fifo' and subprocess.run(['chrt', '-f', '50', 'true'], stderr=subprocess.DEVNULL, check=False).returncode == 0
    parts, goals, begin = arguments.parts.split(','), Goals(), time.monotonic()
    with tempfile.TemporaryDirectory(prefix='dts-peers-') as directory:
        build_peers(arguments.peers_dir, directory + '/build')
        bench = Bench(all_peers(arguments, directory), ('chrt', '-f', '50') if has_fifo else ())
        print(f'## peers\n\nEvery process: {"SCHED_FIFO 50" if has_fifo else "default scheduling"}; network: '
              f'{"a namespace of its own" if os.environ.get(NAMESPACE_MARK) else "the host"}.\n'
              'dtsd: the whole daemon (device, pipeline, publisher) with one stream; _five: four stages and five streams; _stock: the client '
              'is plain libzmq;\nbefore: the older build. age at send: of the newest scan when the publisher sends it.', flush=True)
        if 'latency' in parts:
            latency = Latency(bench, arguments)
            latency.measure()
            latency.show()
            latency.add_goals(goals)
        if 'throughput' in parts:
            measure_throughput(bench, goals, arguments.rounds, arguments.quick)
        if 'memory' in parts:
            measure_memory(bench, goals, 1 if arguments.quick else arguments.rounds, 4 if arguments.quick else 8)
        if 'calls' in parts:
            measure_calls(bench, goals, arguments.rounds, directory)
        if 'stops' in parts:
            measure_stops(bench, goals, 1 if arguments.quick else arguments.rounds, 2 if arguments.quick else 5)
        if 'turns' in parts:
            measure_turns(bench, 4 if arguments.quick else arguments.turn_seconds)
        if 'demo' in parts:
            measure_demo(arguments, goals)
    goals.show()
    print(f'\n{(time.monotonic() - begin) / 60:.0f} min')


main()
