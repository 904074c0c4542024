"""Filters on the system calls of strangers' code."""

from __future__ import annotations

import contextlib
import errno
import os

# System calls that no solution needs. The outer filter holds for the zygote too, which must fork.
OUTER = (
    "ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "pidfd_getfd", "kcmp", "mount", "umount2",
    "pivot_root", "chroot", "move_mount", "open_tree", "fsopen", "fsconfig", "fsmount", "fspick", "mount_setattr",
    "unshare", "setns", "keyctl", "add_key", "request_key", "bpf", "perf_event_open", "userfaultfd",
    "io_uring_setup", "io_uring_enter", "io_uring_register", "kexec_load", "kexec_file_load", "init_module",
    "finit_module", "delete_module", "open_by_handle_at", "name_to_handle_at", "memfd_create", "memfd_secret",
    "shmget", "shmat", "msgget", "semget", "mq_open", "personality", "quotactl", "swapon", "swapoff", "reboot",
    "settimeofday", "clock_settime", "clock_adjtime", "adjtimex", "acct", "syslog", "lookup_dcookie", "vhangup",
    "iopl", "ioperm", "modify_ldt", "fanotify_init", "inotify_init", "inotify_init1", "landlock_create_ruleset",
    "socket", "connect", "bind", "listen", "accept", "accept4",
)  # fmt: skip
# The inner filter is laid over each task before the student's code runs: threads, but no further processes.
INNER = ("fork", "vfork", "execve", "execveat", "kill", "tkill", "pidfd_open", "pidfd_send_signal", "setsid")
_CLONE_THREAD = 0x00010000


def available() -> bool:
    """Whether filters can be made here."""
    try:
        import pyseccomp  # noqa: F401
    except (ImportError, OSError, RuntimeError):
        return False
    return True


def filter_file(names) -> int:
    """A BPF program that lets `names` fail with EPERM, as an open file at its start."""
    import pyseccomp as seccomp

    program = seccomp.SyscallFilter(seccomp.ALLOW)
    for name in names:
        with contextlib.suppress(RuntimeError, ValueError, OSError):  # a call that this system does not know
            program.add_rule(seccomp.ERRNO(errno.EPERM), name)
    if names is INNER:
        # without flags that can be read in a register, libc falls back to clone
        program.add_rule(seccomp.ERRNO(errno.ENOSYS), "clone3")
        program.add_rule(seccomp.ERRNO(errno.EPERM), "clone",
                         seccomp.Arg(0, seccomp.MASKED_EQ, _CLONE_THREAD, 0))  # fmt: skip
    fd = os.memfd_create("seccomp")
    with os.fdopen(os.dup(fd), "wb") as file:
        program.export_bpf(file)
    os.lseek(fd, 0, os.SEEK_SET)
    return fd
