"""A bare Debian in a folder: made from the package source that apt of this machine uses, entered with chroot, removed."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

# What differs after every installation and belongs to no package.
UNCOUNTED = ("proc", "sys", "dev", "run", "tmp", "packages", "home", "var/cache", "var/log", "var/lib/apt")
USER = 1000


def debian_sources():
    """The lines of a sources.list for the Debian that apt of this machine uses, and its code name."""
    said = subprocess.run(["apt-get", "indextargets", "Created-By: Packages", "Origin: Debian", "--format",
                           "$(REPO_URI) $(RELEASE) $(COMPONENT) $(CODENAME)"], capture_output=True, text=True, check=True).stdout
    found = sorted({tuple(line.split()) for line in said.splitlines()})
    if not found:
        raise SystemExit("no Debian among the package sources of apt: run apt-get update, then try again")
    base = min((codename for *_, codename in found), key=len)  # bookworm beside bookworm-updates
    return [f"deb {uri} {release} {component}" for uri, release, component, codename in found if codename.startswith(base)], base


def apt_settings():
    """How apt of this machine reaches its source: proxies, and whether dates are checked."""
    said = subprocess.run(["apt-config", "dump"], capture_output=True, text=True, check=True).stdout
    return [line for line in said.splitlines() if re.match(r"Acquire::(https?|Check-|Retries|ForceIP)", line)]


class Chroot:
    def __init__(self, keep=False):
        self.keep = keep
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="strake-chroot-"))
        self.root = self.place / "debian"

    def __enter__(self):
        try:
            self.make()
        except BaseException:
            self.__exit__()
            raise
        return self

    def make(self):
        sources, name = debian_sources()
        settings = self.place / "apt.conf"
        settings.write_text("\n".join(apt_settings()) + "\n")
        subprocess.run(["mmdebstrap", "--quiet", "--mode=root", "--variant=minbase", f"--aptopt={settings}", name, str(self.root), *sources],
                       check=True, timeout=590)
        for file in ("resolv.conf", "hosts"):
            if pathlib.Path("/etc", file).exists():
                shutil.copy(pathlib.Path("/etc", file), self.root / "etc" / file)
        (self.root / "usr/sbin/policy-rc.d").write_text("#!/bin/sh\nexit 101\n")  # starts no services
        (self.root / "usr/sbin/policy-rc.d").chmod(0o755)
        for folder in ("home/user", "packages"):
            (self.root / folder).mkdir(parents=True)
        os.chown(self.root / "home/user", USER, USER)

    def __exit__(self, *_):
        if self.keep:
            print(f"kept: {self.root}")
        else:
            shutil.rmtree(self.place)

    def give(self, source, name):
        """Copies a folder into the user's home."""
        copy = self.root / "home/user" / name
        shutil.copytree(source, copy)
        for path in (copy, *copy.rglob("*")):
            os.chown(path, USER, USER)
        return copy

    def words(self, command, user):
        """A shell command as words. Its own mounts of /proc and /dev are gone when it ends."""
        inside = "mount --rbind /proc {0}/proc && mount --rbind /dev {0}/dev && exec chroot {1} {0} /bin/sh -c \"$1\"".format(
            self.root, f"--userspec={USER}:{USER}" if user else "")
        return ["unshare", "--mount", "sh", "-c", inside, "sh", ("cd /home/user && " if user else "cd /root && ") + command]

    def environment(self, user):
        own = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "LANG": "C.UTF-8", "NO_COLOR": "1",
               "HOME": "/home/user" if user else "/root", "DEBIAN_FRONTEND": "noninteractive", "MANPAGER": "cat"}
        return own | {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}

    def run(self, command, user=True, code=0, timeout=580):
        """Runs a shell command inside, by default as an ordinary user; its output. SystemExit where it ends with another code."""
        result = subprocess.run(self.words(command, user), env=self.environment(user), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, errors="replace", timeout=timeout)
        if result.returncode != code:
            raise SystemExit(f"FAIL  {command}: exit {result.returncode}, expected {code}\n{result.stdout[-6000:]}")
        return result.stdout

    def lines(self, command):
        """Starts a command as an ordinary user; (process, its lines with the time at which each came)."""
        process = subprocess.Popen(self.words(command, True), env=self.environment(True), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, errors="replace")
        return process, ((time.monotonic(), line.rstrip("\n")) for line in process.stdout)

    def files(self):
        found = set()
        for folder, folders, names in os.walk(self.root):
            here = pathlib.Path(folder).relative_to(self.root).as_posix()
            folders[:] = [name for name in folders if (name if here == "." else f"{here}/{name}") not in UNCOUNTED]
            found.update((name if here == "." else f"{here}/{name}") for name in (*folders, *names))
        return found
