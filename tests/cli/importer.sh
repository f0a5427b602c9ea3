#!/usr/bin/env bash
# The importer's own process: what it is given, how it ends, and that it ends with the program.
. "$(dirname "$0")/common.sh"
command -v python3 >/dev/null && [ -r /proc/self/stat ] || exit 77

# A text that takes the importer a second or so.
python3 - >slow.obj <<'PY'
n = 200000
print("\n".join("v %d 0 0\nv %d 1 0" % (i, i) for i in range(n + 1)))
print("\n".join("f %d %d %d" % (2 * i + 1, 2 * i + 3, 2 * i + 4) for i in range(n)))
PY
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >quick.obj

cat >importer.py <<'PY'
"""importer.py PROGRAM STATUS WORDS SIGNAL [program]: stops the importer in the middle of its file, looks at it, and
sends a signal to it, or to the program."""
import glob, os, signal, subprocess, sys, time

def importer_of(parent):
    for stat in glob.glob("/proc/[0-9]*/stat"):
        try:
            fields = open(stat).read().rsplit(")", 1)[1].split()
            if int(fields[1]) == parent and fields[0] != "Z": return int(stat.split("/")[2])
        except (OSError, IndexError):
            pass

def descriptors(process):
    found = {}
    try:
        for link in glob.glob("/proc/%d/fd/*" % process): found[int(os.path.basename(link))] = os.readlink(link)
    except OSError:
        pass
    return found

program, wanted, words, number = sys.argv[1], int(sys.argv[2]), sys.argv[3], getattr(signal, sys.argv[4])
kept = os.open("quick.obj", os.O_RDONLY)
p = subprocess.Popen([program, "render", "slow.obj", "-t", "hard", "--size", "32x24", "-o", "slow.png"],
                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, pass_fds=[kept],
                     preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
child, seen, end = None, {}, time.time() + 60
while not any(name.endswith("/slow.obj") for name in seen.values()):
    assert p.poll() is None and time.time() < end, "no import was seen: %r" % seen
    child = child or importer_of(p.pid)
    if child: seen = descriptors(child)
os.kill(child, signal.SIGSTOP)
assert kept in descriptors(p.pid), "the test gives the program nothing that could be inherited"
seen = {fd: name for fd, name in descriptors(child).items() if not name.endswith("/slow.obj")}
assert all(seen.pop(fd) == "/dev/null" for fd in range(3)), "standard streams: %r" % seen
assert seen.pop(3).startswith("pipe:") and not seen, "more than the pipe: %r" % seen
os.kill(p.pid if sys.argv[5:] else child, number)
if not sys.argv[5:]:
    try:
        os.kill(child, signal.SIGCONT)
    except ProcessLookupError:
        pass # SIGKILL does not wait for it, and on a busy machine the program has taken note already
out, err = p.communicate(timeout=60)
assert p.returncode == wanted, "status %r: %r" % (p.returncode, err)
assert out == b"" and (words.encode() in err and err.count(b"\n") == 1 if words else err == b""), err
end = time.time() + 10
while os.path.exists("/proc/%d" % child):
    try:
        if open("/proc/%d/stat" % child).read().rsplit(")", 1)[1].split()[0] == "Z": break # for whoever adopted it
    except OSError:
        break
    assert time.time() < end, "the importer outlives the program"
assert not glob.glob("*slow.png*"), "left behind: %r" % os.listdir(".")
PY
importer() { python3 importer.py "$program" "$@" || fail "importer: $*"; }
importer 2 'slow.obj: the importer crashed on it (Aborted)' SIGABRT
importer 1 'slow.obj: the importer was killed' SIGKILL
importer 2 'slow.obj: importing took more than ' SIGXCPU
importer 130 '' SIGINT program
importer 143 '' SIGTERM program
importer -9 '' SIGKILL program

# Without standard streams, each and all.
small="--size 32x24 --map 32 --frames 1 -t hard"
run 0 render quick.obj $small -o wanted.exr
for closed in 0:'<&-' 0:'2>&-' 0:'<&- 2>&-' 1:'>&-' 1:'<&- >&-' 1:'<&- >&- 2>&-'; do
  status=0
  rm -f got.exr
  eval "timeout 100 '$program' render quick.obj $small -o got.exr >/dev/null 2>err ${closed#*:}" || status=$?
  [ "$status" = "${closed%%:*}" ] || fail "status $status with $closed"
  cmp wanted.exr got.exr || fail "another picture with $closed"
done

# The hidden mode is nobody else's: a command that does not exist.
rejected 2 "unknown command '--serve-import'" --serve-import
rejected 2 "unknown command '--serve-import'" --serve-import 1 2 3 quick.obj

# The program renamed and moved, and, where such a place can be made, without /proc.
cp "$program" moved
LD_LIBRARY_PATH=$(dirname "$program")${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export LD_LIBRARY_PATH
timeout 100 ./moved render quick.obj $small -o got.exr >/dev/null 2>err || fail "moved: $(cat err)"
cmp wanted.exr got.exr || fail "another picture of the moved program"
cat >without_proc.sh <<'SH'
umount -l /proc 2>/dev/null || mount -t tmpfs none /proc || exit 77
[ ! -e /proc/self ] || exit 77
exec "$@"
SH
if unshare -rm true 2>/dev/null && ! ldd "$program" | grep -q libasan; then # sanitizers need /proc themselves
  status=0
  timeout 100 unshare -rm sh without_proc.sh ./moved render quick.obj $small -o got.exr >/dev/null 2>err || status=$?
  [ "$status" = 0 ] || [ "$status" = 77 ] || fail "without /proc: status $status: $(cat err)"
fi
finish
