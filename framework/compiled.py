"""Compiled code: where it is kept, and that the first use of it says so instead of seeming to hang.

A kernel module is one named `*_kernel.py` or `*_kernels.py`. It imports Numba, so that whoever needs it imports it
late; its function `warm()` compiles all of it; of this project it imports other kernel modules alone, since its cache
is keyed by their sources. When a process imports its first one, `prepare` sets Numba's cache folder and compiles,
where that has not been done on this machine, all of them.
"""

import functools
import json
import os
import subprocess
import sys
import warnings
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
_HOMES = ("framework", "solutions/fast")
_NAMES = ("_kernel", "_kernels")
_UNUSED_DAYS = 30
# Where set, `prepare` copies compiled code from this folder and compiles nothing. Sandboxes need that: their processes
# may write nothing that others read, and start no processes.
COPIED_FROM = "COURSE_COMPILED"


def kernel_modules():
    """Names of the kernel modules installed here, largest first."""
    paths = [path for home in _HOMES for name in _NAMES for path in (_ROOT / home).glob(f"*{name}.py")]
    paths.sort(key=lambda path: (-path.stat().st_size, path))
    return [".".join(path.relative_to(_ROOT).with_suffix("").parts) for path in paths]


@functools.cache
def folder():
    """Where this installation's compiled code lies, by the hash of all that it depends on: a Path."""
    import hashlib

    import platformdirs

    digest = hashlib.sha256("\n".join(_surroundings()).encode())
    for name in sorted(kernel_modules()):
        digest.update(name.encode() + _source(name).read_bytes())
    root = os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_dir("envmap-course", appauthor=False)
    return Path(root) / f"compiled-{digest.hexdigest()[:16]}"


def is_complete():
    """Whether all kernels have been compiled."""
    return _marker().exists()


def prepare():
    """Set Numba's cache folder, and fill it if that is yet to be done, with a progress line on stderr."""
    if _BeforeTheFirstKernel in sys.meta_path:
        sys.meta_path.remove(_BeforeTheFirstKernel)
    import numba

    try:
        folder().mkdir(parents=True, exist_ok=True)
    except OSError:
        return  # Numba then finds a place by itself
    numba.config.CACHE_DIR = str(folder())  # type: ignore[attr-defined]
    if COPIED_FROM in os.environ:
        _copy(os.environ[COPIED_FROM])
    elif is_complete():
        os.utime(_marker())
    elif not numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        with open(folder() / "lock", "w") as lock:
            _wait_for(lock)
            if not is_complete():
                keys = _keys()
                _compile_all([name for name in keys if not _take_over(name, keys[name])])
                _remove_unused()
                _marker().write_text(json.dumps(keys))


class _BeforeTheFirstKernel:
    """On `sys.meta_path` until a kernel module is imported, whoever does it: finds nothing, but calls `prepare`."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.endswith(_NAMES) and name in kernel_modules():
            prepare()
        return None


sys.meta_path.insert(0, _BeforeTheFirstKernel)


def _marker():
    return folder() / "complete"


def _source(name):
    return _ROOT.joinpath(*name.split(".")).with_suffix(".py")


def _surroundings():
    """What all compiled code depends on."""
    import importlib.metadata

    versions = [importlib.metadata.version(name) for name in ("numba", "llvmlite", "numpy")]
    return [sys.version, _processor(), str(_ROOT), *versions]


def _processor():
    """What tells this kind of processor from others."""
    import platform

    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return "\n".join(sorted({line for line in lines if line.startswith(("model name", "flags", "Features"))}))


def _wait_for(lock):
    """Until no other process compiles; where files cannot be locked both do, which costs time and harms nothing."""
    try:
        import fcntl
    except ImportError:
        return
    fcntl.flock(lock, fcntl.LOCK_EX)


def _compile_all(names):
    """In as many processes as there are cores, which this one is not: it starts no threads of Numba's.

    A module waits for those whose kernels it calls, and links what they have compiled. Of those that need not wait, the
    one goes first that most depends on.
    """
    from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait

    from tqdm import tqdm

    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    needs = {name: (_needed(name) - {name}) & set(names) for name in names}
    left = sorted(names, key=lambda name: -_work_behind(name, needs))
    crews = [_Compiler() for _ in range(min(cores, len(names)))]
    running: dict = {}
    try:
        with ThreadPoolExecutor(cores) as pool, tqdm(
            total=len(names), desc="compiling the renderer (once)", unit="module", leave=False
        ) as line:
            while left or running:
                unmet = {*left, *(name for name, _ in running.values())}
                ready = [name for name in left if not needs[name] & unmet]
                for name, crew in zip(ready, crews, strict=False):
                    left.remove(name)
                    running[pool.submit(crew.compile, name)] = name, crew
                crews = crews[min(len(ready), len(crews)) :]
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for job in done:
                    name, crew = running.pop(job)
                    crews.append(crew)
                    if job.result():
                        warnings.warn(f"{name} could not be compiled: {job.result()}", stacklevel=1)
                    line.update()
    finally:
        for crew in [*crews, *(crew for _, crew in running.values())]:
            crew.close()


def _work_behind(name, needs):
    """Bytes of source of a module and of all that wait for it: what compiling takes goes with it."""
    waiting = [name, *(other for other in needs if name in needs[other])]
    return sum(_source(other).stat().st_size for other in waiting if _source(other).exists())


class _Compiler:
    """A process that compiles the modules whose names it is sent, one after the other."""

    _CODE = """
import importlib, sys
import framework.compiled
answers = sys.stdout
sys.stdout = sys.stderr
for name in sys.stdin:
    try:
        importlib.import_module(name.strip()).warm()
        print(file=answers, flush=True)
    except Exception as error:
        print(type(error).__name__, ": ", str(error).partition(chr(10))[0], sep="", file=answers, flush=True)
"""

    def __init__(self):
        self._start()

    def _start(self):
        environment = os.environ | {COPIED_FROM: "", "PYTHONPATH": str(_ROOT)}
        self._process = subprocess.Popen(
            [sys.executable, "-c", self._CODE],
            env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip

    def compile(self, name):
        """What went wrong, in a line; "" where nothing did."""
        if self._process.poll() is not None:
            self.close()
            self._start()
        names, answers = self._process.stdin, self._process.stdout
        assert names and answers
        try:
            names.write(f"{name}\n")
            names.flush()
            return (answers.readline() or "the process that compiled it ended\n").strip()
        except OSError as error:
            return str(error)

    def close(self):
        self._process.kill()
        self._process.communicate()


def _keys():
    """Of each kernel module, the hash of what its compiled code depends on: its source, and those of kernels it names."""
    import hashlib

    keys = {}
    for name in kernel_modules():
        digest = hashlib.sha256("\n".join(_surroundings()).encode())
        for other in sorted(_needed(name)):
            digest.update(other.encode() + _source(other).read_bytes())
        keys[name] = digest.hexdigest()
    return keys


def _needed(name):
    """A kernel module and those that it names, directly or through others: a set."""
    sources = {other: _source(other).read_text() for other in kernel_modules()}
    needed, new = {name}, [name]
    while new:
        text = sources.get(new.pop(), "")
        found = {other for other in sources if other.rpartition(".")[2] in text} - needed
        needed |= found
        new += found
    return needed


def _take_over(name, key):
    """Copy a module's compiled code from the folder of other sources, where it is the same there; whether it was."""
    import shutil

    for marker in folder().parent.glob("compiled-*/complete"):
        text = marker.read_text()
        if text and json.loads(text).get(name) == key:
            for path in marker.parent.glob(f"*/{name.rpartition('.')[2]}.*"):
                home = folder() / path.parent.name
                home.mkdir(exist_ok=True)
                shutil.copyfile(path, home / path.name)
            return True
    return False


def _copy(warm):
    """Copy a folder of compiled code, "" for none: Numba names subfolders after a path that is another one here."""
    import shutil

    from numba.core.caching import UserProvidedCacheLocator

    for home in _HOMES:
        name = UserProvidedCacheLocator.get_suitable_cache_subpath(str(_ROOT / home / "_"))
        for source in Path(warm).glob(f"{Path(home).name}_*") if warm else ():
            shutil.copytree(source, folder() / name, dirs_exist_ok=True)


def _remove_unused():
    """Folders of other installations, or of older sources, that no process has asked for in a month."""
    import shutil
    import time

    for other in folder().parent.glob("compiled-*"):
        marker = other / "complete"
        if time.time() - (marker if marker.exists() else other).stat().st_mtime > _UNUSED_DAYS * 86400:
            shutil.rmtree(other, ignore_errors=True)
