"""What a stranger may put into the body of a function: name -> (code, the statuses that are right for its task).

CANARY stands for a secret file of the instructor's, PORT for a port that somebody listens on, OUTSIDE for a folder that
the grader's user may write to. A cell that gets hold of something prints it, and the drill looks for it in all that is kept.
"""

FAILS = {"error", "crashed", "out_of_memory", "timeout"}
ANY = FAILS | {"pass", "fail", "partial"}

CELLS = {
    # reads
    "reads the canary": ("print(open(CANARY).read())", FAILS),
    "reads it by a link": ("import os; os.symlink(CANARY, 'l'); print(open('l').read())", FAILS),
    "reads it through /proc": ("import glob; [print(open(f + CANARY).read()) for f in glob.glob('/proc/*/root')]", ANY),
    "reads other processes' words": ("import glob; [print(open(f, 'rb').read()) for f in glob.glob('/proc/*/cmdline')]", ANY),
    "reads the environment": ("import os; print(dict(os.environ))", ANY),
    "reads its parent's environment": ("import os; print(open(f'/proc/{os.getppid()}/environ', 'rb').read())", FAILS),
    "reads its parent's memory": ("import os; open(f'/proc/{os.getppid()}/mem', 'rb').read(1)", FAILS),
    "lists the home": ("import os; print(os.listdir('/root'))", ANY),
    "lists other homes": ("import os; print([os.listdir('/home/' + h) for h in os.listdir('/home')] + 1)", FAILS),
    "reads passwords": ("print(open('/etc/shadow').read())", FAILS),
    "reads the disk": ("import glob; print(open(sorted(glob.glob('/dev/[vsn]d*') + ['/dev/sda'])[0], 'rb').read(512))", FAILS),
    "imports the solutions": ("import solutions.sphere_tracing as s; return s.sdf_sphere(p, center, radius)", FAILS),
    "imports the checks": ("import autograder.checks.sphere_tracing", FAILS),
    "imports the mistakes": ("import autograder.mistakes.sphere_tracing", FAILS),
    "imports the references": ("import autograder.references", FAILS),
    "walks for the solutions": ("""
import os
for folder, _, files in os.walk('/'):
    for name in files:
        if 'sphere_tracing' in name or name == 'tolerances.json':
            print('FOUND', folder, name)
raise OSError('done')""", {"error", "timeout"}),
    "walks for other submissions": ("""
import os
found = [os.path.join(f, n) for f, _, names in os.walk('/') for n in names if n.endswith('tracing.ipynb')]
print('FOUND' if found else 'nothing', found)
raise OSError('done')""", {"error", "timeout"}),
    "looks for the grader's objects": ("""
import gc
print('FOUND' if [o for o in gc.get_objects() if 'Judgement' in type(o).__name__ or 'Trial' in type(o).__name__] else 'nothing')
raise OSError('done')""", {"error"}),
    "reads inherited files": ("import os; [print(os.read(fd, 99)) for fd in range(3, 64) if os.fstat(fd)]", ANY),
    # writes
    "writes outside": ("open(OUTSIDE + '/mark', 'w').write('x')", FAILS),
    "writes into the home": ("import os; open(os.path.expanduser('~root/mark'), 'w')", FAILS),
    "writes into the framework": ("import framework; open(framework.__file__, 'a').write('x')", FAILS),
    "writes into NumPy": ("open(np.__file__, 'a').write('x')", FAILS),
    "writes into the interpreter": ("import sys; open(sys.executable, 'r+b').write(b'x')", FAILS),
    "leaves compiled code": ("import glob; open(glob.glob('/course/**/*.nbi', recursive=True)[0], 'wb')", FAILS),
    "fills the scratch folder": ("[open(f'f{i}', 'wb').write(bytes(8 << 20)) for i in range(999)]", FAILS),
    "fills shared memory": ("[open(f'/dev/shm/f{i}', 'wb').write(bytes(1 << 20)) for i in range(999)]", FAILS),
    "makes a million files": ("[open(f'f{i}', 'w').close() for i in range(10**6)]", ANY),
    "makes deep folders": ("import os\nfor _ in range(10**5):\n    os.mkdir('d'); os.chdir('d')", ANY),
    "removes what it can": ("import shutil; shutil.rmtree('/', ignore_errors=True); raise OSError('done')", FAILS),
    "changes permissions": ("import os; os.chmod('/scratch', 0o4777); os.chown('/scratch', 12345, 12345)", ANY),
    "mounts": ("import ctypes; raise OSError(ctypes.CDLL(None).mount(b'/', b'/scratch', None, 4096, None))", FAILS),
    # network
    "connects": ("import socket; socket.create_connection(('127.0.0.1', PORT), 2).send(b'x')", FAILS),
    "connects by IPv6": ("import socket; socket.create_connection(('::1', PORT), 2).send(b'x')", FAILS),
    "sends a datagram": ("import socket; socket.socket(2, 2).sendto(b'x', ('127.0.0.1', PORT))", FAILS),
    "asks by HTTP": ("import urllib.request; print(urllib.request.urlopen(f'http://127.0.0.1:{PORT}/').read())", FAILS),
    "asks for a name": ("import socket; print(socket.gethostbyname('localhost.localdomain'))", FAILS | {"fail"}),
    "opens a raw socket": ("import socket; socket.socket(socket.AF_PACKET, socket.SOCK_RAW)", FAILS),
    "listens": ("import socket; s = socket.socket(); s.bind(('0.0.0.0', 0)); s.listen()", FAILS),
    # processes
    "forks": ("import os; os.fork()", FAILS),
    "bombs": ("import os\nwhile True:\n    os.fork()", FAILS),
    "runs a program": ("import os; raise OSError(os.system('touch ' + OUTSIDE + '/mark'))", FAILS),
    "replaces itself": ("import os; os.execv('/usr/bin/true', ['true'])", FAILS),
    "kills its parent": ("import os, signal; os.kill(os.getppid(), signal.SIGKILL)", FAILS),
    "kills everything": ("import os, signal; os.kill(-1, signal.SIGKILL)", FAILS),
    "stops itself": ("import os, signal; os.kill(os.getpid(), signal.SIGSTOP)", FAILS),
    "starts many threads": ("import threading, time\nfor _ in range(9999):\n    threading.Thread(target=time.sleep, args=(9,)).start()", ANY),
    "leaves a thread behind": ("import threading, time; threading.Thread(target=time.sleep, args=(999,)).start()", ANY),
    "traces": ("import ctypes; raise OSError(ctypes.CDLL(None).ptrace(16, 1, 0, 0))", FAILS),
    "uses io_uring": ("import ctypes; raise OSError(ctypes.CDLL(None).syscall(425, 8, 0))", FAILS),
    "makes a namespace": ("import ctypes; raise OSError(ctypes.CDLL(None).unshare(0x10000000))", FAILS),
    "becomes root": ("import os; os.setuid(0); os.seteuid(0); print(open(CANARY).read())", FAILS),
    # time, memory, output
    "never ends": ("while True:\n    pass", {"timeout"}),
    "never ends in C": ("return np.sum(range(10**12))", {"timeout", "out_of_memory", "crashed"}),
    "sleeps": ("import time; time.sleep(10**6)", {"timeout"}),
    "sleeps and catches": ("import time\nwhile True:\n    try:\n        time.sleep(10**6)\n    except BaseException:\n        pass", {"timeout"}),
    "ignores the signal": ("import signal; signal.signal(signal.SIGXCPU, signal.SIG_IGN)\nwhile True:\n    pass", {"timeout", "crashed"}),
    "takes all memory": ("a = [np.ones(1 << 24) for _ in range(9999)]", {"out_of_memory", "crashed", "error"}),
    "recurses": ("f = lambda: f()\nreturn f()", {"error", "crashed"}),
    "recurses in C": ("import sys; sys.setrecursionlimit(10**9); f = lambda: f()\nreturn f()", FAILS),
    "prints without end": ("while True:\n    print('x' * 9999)", {"timeout"}),
    "prints a page": ("print('<script>document.title=\"owned\"</script>')", {"fail"}),
    "raises megabytes": ("raise ValueError('<script>document.title=\"owned\"</script>' * 10**6)", {"error"}),
    "raises what cannot be shown": ("class E(Exception):\n    def __str__(self): raise E\nraise E", {"error"}),
    "dies": ("import ctypes; ctypes.string_at(1)", {"crashed"}),
    "leaves": ("import os; os._exit(0)", {"crashed"}),
    # judgement
    "is an array in disguise": ("class A(np.ndarray):\n    def __array_finalize__(self, o): raise KeyboardInterrupt\nreturn p.view(A)", FAILS),
    "returns a bomb": ("class B:\n    def __array__(self, *a, **k): import os; os._exit(0)\nreturn B()", FAILS),
    "returns a pickle": ("class B:\n    def __reduce__(self): return (print, ('FOUND',))\nreturn B()", FAILS),
    "returns terabytes": ("return np.broadcast_to(1.0, (10**6, 10**6))", {"error"}),
    "speaks the protocol": ("import gc, os\nfor o in gc.get_objects():\n    if type(o).__name__ == 'Task': o.link.sendall(os.urandom(4096))", FAILS),
    "answers for the grader": ("import gc\nfor o in gc.get_objects():\n    if type(o).__name__ == 'Task': o.link.recv(4096)\nreturn p[..., 0]", FAILS | {"fail"}),
    "patches NumPy": ("np.abs = np.max = np.asarray = lambda *a, **k: 0.0\nreturn 0 * p[..., 0]", {"fail", "error"}),
    "patches the worker": ("import autograder.wall as w; w.as_promised = lambda *a: []; return p[..., 0]", FAILS | {"fail"}),
    "changes the inputs": ("p[...] = 0; return np.zeros(p.shape[:-1])", {"fail", "error"}),
    "lies about equality": ("class Z(float):\n    def __eq__(self, o): return True\nreturn np.full(p.shape[:-1], Z(0), dtype=object)", {"error"}),
}  # fmt: skip
HARMLESS_WHEN_WEAK = ("reads the canary", "reads it by a link", "reads the environment", "writes outside", "connects",
                      "runs a program", "imports the solutions", "forks", "never ends", "dies")  # fmt: skip
