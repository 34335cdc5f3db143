# SPDX-License-Identifier: Apache-2.0
"""Which Debian packages a program is made of: asked of the linker's and the compiler's records and of dpkg."""
import dataclasses
import re
import subprocess
import urllib.parse
from pathlib import Path

COPYRIGHT = "/usr/share/doc/{}/copyright"


@dataclasses.dataclass(frozen=True, order=True)
class Package:
    name: str
    version: str
    architecture: str
    source: str
    licence: str = "NOASSERTION"  # Debian's copyright files are for people

    supplier = "Organization: Debian"
    checksum = None

    @property
    def purl(self) -> str:
        name, version = (urllib.parse.quote(text, safe="~") for text in (self.name, self.version))
        return f"pkg:deb/debian/{name}@{version}?arch={self.architecture}"

    @property
    def notice(self) -> str:
        return Path(COPYRIGHT.format(self.name)).read_text()


def run(*words: str) -> str:
    environment = {"LC_ALL": "C.UTF-8", "PATH": "/usr/sbin:/usr/bin:/sbin:/bin"}
    return subprocess.run(words, check=True, capture_output=True, text=True, env=environment).stdout


def look_up(names: list[str]) -> list[Package]:
    """Installed packages, in the order of their names."""
    if not names:
        return []
    listing = run("dpkg-query", "-W", "-f", "${Package}\t${Version}\t${Architecture}\t${source:Package}\n", *names)
    return sorted({Package(*line.split("\t")) for line in listing.splitlines()})


def versions() -> dict[str, str]:
    """Those that Debian has in names of packages: libboost1.83-dev, g++-14."""
    boost = look_up(["libboost-dev"])[0].version
    return {"boost": ".".join(boost.split(".")[:2]), "gcc": run("g++", "-dumpversion").strip().split(".")[0]}


def owners(files: list[str]) -> set[str]:
    """Names of the packages that own the files. On a merged /usr dpkg may know a library by its old name in /lib."""
    found: dict[str, str] = {}
    asked = sorted({name for file in files for name in (file, file.removeprefix("/usr"))})
    answer = subprocess.run(["dpkg-query", "-S", *asked], capture_output=True, text=True, check=False)
    for line in answer.stdout.splitlines():
        packages, _, file = line.rpartition(": ")
        if packages and not packages.startswith("diversion by"):
            found[file] = packages.split(",")[0].split(":")[0]
    missing = [file for file in files if file not in found and file.removeprefix("/usr") not in found]
    if missing:
        raise SystemExit(f"sbom: no package owns {missing[0]}")
    return {found.get(file) or found[file.removeprefix("/usr")] for file in files}


def linked_to(programs: list[Path]) -> tuple[list[Package], list[Package]]:
    """Packages of the shared libraries that the programs name themselves, and of those that these need in turn."""
    direct: set[str] = set()
    every: set[str] = set()
    for program in programs:
        needed = re.findall(r"^ *NEEDED +(\S+)$", run("objdump", "-p", str(program)), re.MULTILINE)
        paths = dict(re.findall(r"^\t(\S+) => (/\S+) \(", run("ldd", str(program)), re.MULTILINE))
        libraries = {name: str(Path(path).resolve()) for name, path in paths.items()}
        every |= owners(sorted(libraries.values()))
        direct |= owners(sorted(libraries[name] for name in needed if name in libraries))
    return look_up(sorted(direct)), look_up(sorted(every - direct))


def headers_read(build: Path, programs: list[str]) -> set[str]:
    """Packages of all system headers that the objects of these programs and shared libraries were compiled with."""
    targets = [f"lib/{name}" if ".so" in name else f"bin/{name}" for name in programs]
    inputs = [run("ninja", "-C", str(build), "-t", "inputs", target).splitlines() for target in targets]
    objects = {line for lines in inputs for line in lines if line.endswith(".o")}
    headers: set[str] = set()
    is_ours = False
    recorded: set[str] = set()
    for line in run("ninja", "-C", str(build), "-t", "deps").splitlines():
        if not line.startswith(" "):
            target = line.split(":")[0]
            is_ours = target in objects
            recorded |= {target} if is_ours else set()
        elif is_ours and line.strip().startswith("/usr/"):
            headers.add(str(Path(line.strip()).resolve()))
    if recorded != objects or not objects:
        raise SystemExit(f"sbom: ninja has no record of {sorted(objects - recorded)[:1] or programs}")
    return owners(sorted(headers))
