"""Builds wheels and sdists of the module (PEP 517). scikit-build-core does the work where it is installed. Elsewhere CMake
is run with the same settings, those in pyproject.toml, and the files are packed here (PEP 427, PEP 643).

build_core_wheel() makes a wheel of the core, which carries its libraries: python/build calls it.

A setting for the build, as `pip wheel --config-settings build-dir=DIR`: the folder of CMake's build, kept for the next one.
"""
import base64
import gzip
import hashlib
import io
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

try:
    from scikit_build_core import build as scikit
except ImportError:
    scikit = None

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOT_SOURCES = re.compile(r"^(build[^/]*|out|\.git|\.github)(/|$)|(^|/)__pycache__/|\.(tmp|whl|pyc)$|^PKG-INFO$|^docs/pictures/.*\.(png|webp)$")


def _settings():
    import tomllib  # from Python 3.11 on

    return tomllib.loads((ROOT / "pyproject.toml").read_text())


def _version():
    return re.search(r"project\(kerf VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def _metadata():
    project = _settings()["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {_version()}", f"Summary: {project['description']}",
             f"License: {project['license']['text']}", f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    lines += ["Description-Content-Type: text/markdown", "", (ROOT / project["readme"]).read_text()]
    return "\n".join(lines)


def _tag(platform=None):
    python = "cp%d%d" % sys.version_info[:2]
    return f"{python}-{python}-{platform or re.sub('[-.]', '_', sysconfig.get_platform())}"


def _run(*command):
    # The output of the build is that of pip -v; errors are shown either way.
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


def _time():
    """Seconds since 1970 that all files are given: equal sources make equal archives."""
    if "SOURCE_DATE_EPOCH" in os.environ:
        return int(os.environ["SOURCE_DATE_EPOCH"])
    git = subprocess.run(["git", "-C", ROOT, "log", "-1", "--format=%ct"], capture_output=True, text=True)
    return int(git.stdout) if git.returncode == 0 and git.stdout.strip() else 1577836800


def _manylinux():
    """The platform of a wheel that needs nothing but as new a C library as this machine's (PEP 600)."""
    name = re.sub("[-.]", "_", sysconfig.get_platform())
    library, _, version = os.confstr("CS_GNU_LIBC_VERSION").partition(" ")
    if library != "glibc" or not name.startswith("linux_"):
        raise RuntimeError(f"a wheel with its libraries is made on Linux with glibc, not on {name} with {library}")
    return name.replace("linux", "manylinux_" + version.replace(".", "_"), 1)


def _installed(build, stage):
    """Builds the module and installs it below `stage`."""
    scikit_build = _settings()["tool"]["scikit-build"]
    defines = [f"-D{name}={value}" for name, value in scikit_build["cmake"]["define"].items()]
    _run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}", *defines)
    _run("cmake", "--build", build, "--target", *scikit_build["build"]["targets"])
    for component in scikit_build["install"]["components"]:
        _run("cmake", "--install", build, "--prefix", stage, "--component", component, "--strip")


def _pack(wheel, files):
    """Writes (name, bytes) pairs as a wheel; RECORD comes last and lists the others."""
    info = f"kerf-{_version()}.dist-info"
    record = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        def add(name, content):
            entry = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if ".so" in name else 0o100644) << 16
            archive.writestr(entry, content)

        for name, content in files:
            add(name, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(content)}")
        record.append(f"{info}/RECORD,,")
        add(f"{info}/RECORD", "\n".join(record) + "\n")


def _information(platform=None):
    """The wheel's .dist-info without RECORD, as (name, bytes) pairs."""
    wheel = f"Wheel-Version: 1.0\nGenerator: kerf_backend\nRoot-Is-Purelib: false\nTag: {_tag(platform)}\n"
    texts = {"METADATA": _metadata(), "WHEEL": wheel, "LICENSE": (ROOT / "LICENSE").read_text()}
    return [(f"kerf-{_version()}.dist-info/{name}", text.encode()) for name, text in texts.items()]


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    if scikit:
        return scikit.build_wheel(wheel_directory, config_settings, metadata_directory)
    with tempfile.TemporaryDirectory() as work:
        stage = pathlib.Path(work) / "stage"
        _installed((config_settings or {}).get("build-dir") or pathlib.Path(work) / "build", stage)
        return _packed(wheel_directory, stage)


def build_core_wheel(wheel_directory, build):
    """A wheel of the core. `build`: folder of a build of either edition, or of one that is made here."""
    build = pathlib.Path(build)
    if not (build / "CMakeCache.txt").exists():
        switches = dict(KERF_CORE="ON", KERF_PYTHON="ON", KERF_PYTHON_DIR=".", KERF_TESTS="OFF", KERF_C="OFF", KERF_UNITY="ON")
        _run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}",
             *(f"-D{name}={value}" for name, value in switches.items()))
    _run("cmake", "--build", build, "--target", "kerf_python_core")
    with tempfile.TemporaryDirectory() as stage:
        _run("cmake", "--install", build, "--prefix", stage, "--component", "python_core", "--strip")
        return _packed(wheel_directory, pathlib.Path(stage), _manylinux())


def _packed(wheel_directory, stage, platform=None):
    """Packs the package that is installed below `stage`; the wheel's name."""
    files = [(str(path.relative_to(stage)), path.read_bytes()) for path in sorted((stage / "kerf").rglob("*")) if path.is_file()]
    if not any(name.endswith(".so") for name, _ in files):
        raise RuntimeError("the build installed no extension")
    name = f"kerf-{_version()}-{_tag(platform)}.whl"
    _pack(pathlib.Path(wheel_directory) / name, files + _information(platform))
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    if scikit:
        return scikit.prepare_metadata_for_build_wheel(metadata_directory, config_settings)
    for name, content in _information():
        path = pathlib.Path(metadata_directory) / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
    return f"kerf-{_version()}.dist-info"


def _sources():
    """Paths of the sources: what git knows, or all files of an unpacked sdist."""
    git = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True)
    if git.returncode == 0 and (ROOT / ".git").exists():
        names = git.stdout.decode().split("\0")
    else:
        names = [str(path.relative_to(ROOT)) for path in ROOT.rglob("*")]
    return sorted(name for name in names if name and not NOT_SOURCES.search(name) and (ROOT / name).is_file())


def build_sdist(sdist_directory, config_settings=None):
    if scikit:
        return scikit.build_sdist(sdist_directory, config_settings)
    top, time = f"kerf-{_version()}", _time()
    path = pathlib.Path(sdist_directory) / f"{top}.tar.gz"
    with open(path, "wb") as raw, gzip.GzipFile("", "wb", mtime=time, fileobj=raw) as packed:
        with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
            def add(name, content, mode):
                entry = tarfile.TarInfo(f"{top}/{name}")
                entry.size, entry.mode, entry.mtime = len(content), mode, time
                archive.addfile(entry, io.BytesIO(content))

            add("PKG-INFO", _metadata().encode(), 0o644)
            for name in _sources():
                add(name, (ROOT / name).read_bytes(), 0o755 if os.access(ROOT / name, os.X_OK) else 0o644)
    return path.name
