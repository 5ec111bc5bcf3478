"""Repose from Python: tables, stores of sweeps and frames of runs as columns of numbers; scenes and sweeps run
through the program. One file, standard library alone; columns are numpy arrays where numpy is installed, and
Table.dataframe() needs pandas.

    import repose
    pile = repose.run("scene.cfg", "out", every=1000, set={"tangential.mu": 0.3})
    for frame in pile:
        print(frame.t, max(frame.grains["y"]))
    hopper = repose.run("hopper.cfg", D=1.6)
    print(hopper.status, hopper.measures["rate"], hopper.units["rate"])
    runs = repose.sweep("lh3.cfg", "lh3")
    print(runs["theta_r3_deg"], runs.units["theta_r3_deg"])

The program is $REPOSE; else that of the source or of the installation in which this file lies; else `repose` on the PATH.
"""
import json
import os
import pathlib
import shutil
import subprocess

try:
    import numpy
except ImportError:
    numpy = None


class Error(Exception):
    """The program failed: its message, and its exit status as `status`."""

    def __init__(self, message, status):
        super().__init__(message, status)
        self.status = status

    def __str__(self):
        return self.args[0]


def _number(text):
    if isinstance(text, bool):
        return None
    try:
        return float("inf" if text == "infinite" else text)
    except (TypeError, ValueError):
        return None


def _column(cells):
    """Numbers if every cell is one (None of a store is nan), else the cells as they are."""
    values = [float("nan") if c is None else _number(c) for c in cells]
    if None in values:
        return list(cells)
    return numpy.array(values) if numpy else values


class Table:
    """Columns by name: table["x"]. `units` by column and `notes` (the provenance) are dictionaries of texts."""

    def __init__(self, names, rows, units=None, notes=None):
        self.names, self.rows = list(names), list(rows)
        self.units, self.notes = dict(units or {}), dict(notes or {})
        self._columns = {}

    def __len__(self):
        return len(self.rows)

    def __contains__(self, name):
        return name in self.names

    def __getitem__(self, name):
        if name not in self._columns:
            k = self.names.index(name) if name in self.names else None
            if k is None:
                raise KeyError(f"no column {name!r} among {', '.join(self.names)}")
            if self.names.count(name) > 1:
                raise KeyError(f"several columns {name!r}")
            self._columns[name] = _column([row[k] for row in self.rows])
        return self._columns[name]

    def where(self, name, value):
        """The rows whose number or word in this column equals `value`."""
        keep = [row for row, cell in zip(self.rows, self[name]) if cell == value]
        return Table(self.names, keep, self.units, self.notes)

    def dataframe(self):
        """The same as a pandas.DataFrame."""
        import pandas

        return pandas.DataFrame({name: self[name] for name in self.names})


def parse_table(text):
    """A Table from the text that the program prints."""
    notes, names, rows, units, line = {}, None, [], "", ""
    for line in text.split("\n"):  # splitlines() would end lines at signs that names may have
        if line.startswith("#"):
            key, colon, value = line[1:].strip(" ").partition(": ")
            if rows or names:
                continue
            if colon:
                notes[key] = value
            elif key:
                names = key.split("\t")  # an older version's
        elif names is None:
            names = line.split("\t")
        elif line:
            rows.append(line.split("\t"))
    names = names or []
    units = dict(zip(names, notes.pop("units", "").split("\t")))
    return Table(names, rows, units, notes)


def read_table(path):
    """A Table from a file of the program (.tsv)."""
    return parse_table(pathlib.Path(path).read_text(encoding="utf-8", errors="surrogateescape"))


def read_store(path):
    """The stored runs of a sweep's folder (or of that of its store.sqlite), with all parameters and outputs as columns.
    The program reads them, those of shards that are not merged too; notes["missing"] says how many
    are not stored."""
    path = pathlib.Path(path).absolute()
    found = json.loads(_output("export", path.parent if path.name == "store.sqlite" else path, "--to", "json", allowed=(0, 1)))
    names = list(found["units"])
    return Table(names, [[row[name] for name in names] for row in found["rows"]], found["units"], found["notes"])


class Frame:
    """One moment of a run: `step`, `t`, and the Tables `grains`, `contacts` and `walls`."""

    def __init__(self, step, t, grains, contacts, walls):
        self.step, self.t = step, t
        self.grains, self.contacts, self.walls = grains, contacts, walls


def _by_step(table):
    """Tables of the rows with equal steps, by step, in order."""
    parts = {}
    if table is not None and len(table):
        k = table.names.index("step")
        for row in table.rows:
            parts.setdefault(float(row[k]), []).append(row)
    return {step: Table(table.names, rows, table.units, table.notes) for step, rows in parts.items()}


def read_frames(folder):
    """The Frames of a run, from the folder that `repose run -o` has written."""
    folder = pathlib.Path(folder)
    tables = {}
    for name in ("states", "contacts", "walls", "energy"):
        path = folder / f"{name}.tsv"
        tables[name] = read_table(path) if path.exists() or name == "states" else None
    parts = {name: _by_step(table) for name, table in tables.items()}
    times = {step: grains["t"][0] for step, grains in parts["states"].items()}
    for step, energy in parts["energy"].items():
        if energy["grains"][0] == 0:  # all have left
            times.setdefault(step, energy["t"][0])

    def at(name, step):
        table = tables[name]
        return parts[name].get(step, Table(table.names, [], table.units, table.notes)) if table is not None else None

    return [Frame(int(step), times[step], at("states", step), at("contacts", step), at("walls", step))
            for step in sorted(times)]


def program():
    """Path of the program."""
    here = pathlib.Path(__file__).resolve().parent
    beside = [os.path.normpath(here / name) for name in ("../build/repose", "../../../bin/repose")]
    found = os.environ.get("REPOSE") or next(filter(os.path.exists, beside), None) or shutil.which("repose")
    if not found:
        raise FileNotFoundError("no program repose: make it, install it, or set REPOSE to its path")
    return found


def _answer(*words, allowed=(0,)):
    """What the program prints, its message, and its exit status, one of those allowed."""
    done = subprocess.run([program(), *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          encoding="utf-8", errors="surrogateescape")
    if done.returncode not in allowed:
        raise Error(done.stderr.strip(), done.returncode)
    return done.stdout, done.stderr.strip(), done.returncode


def _output(*words, allowed=(0,)):
    return _answer(*words, allowed=allowed)[0]


def command(*words, allowed=(0,)):
    """The Table that a command prints: command("angle", "slope", "grains.tsv", "--width", 4).
    Raises Error unless the exit status is among those allowed; 1 means that a command has no result."""
    return parse_table(_output(*words, allowed=allowed))


def _value(text):
    """A number, true or false, or a word."""
    try:
        return {"true": True, "false": False}[text] if text in ("true", "false") else float(text)
    except ValueError:
        return text


class Run:
    """What an experiment, a scene with phases, has given: its `status` and `message`, `measures` and their `units` by
    name, its names' values `let`, and with a folder its `frames`. A measure without a value is nan."""

    def __init__(self, table, frames):
        self.status, self.message = table.notes.get("status", ""), table.notes.get("message", "")
        self.let = {key[4:]: _value(text) for key, text in table.notes.items() if key.startswith("let ")}
        self.measures = dict(zip(table["measure"], map(float, table["value"])))
        self.units = dict(zip(table["measure"], table["unit"]))
        self.frames = frames


def run(scene, folder=None, every=None, set=None, options=(), **lets):
    """Simulate a scene into a folder, a frame every `every` steps, with keys of the scene replaced by `set`, and its
    own names by keywords, as D=1.6. Returns its Frames; of a scene with phases a Run, which needs no folder."""
    words = ["run", scene, *(["-o", folder] if folder else []), *options]
    if every is not None:
        words += ["--every", every]
    for key, value in {**(set or {}), **lets}.items():
        words += ["--set", f"{key}={str(value).lower() if isinstance(value, bool) else value}"]
    printed, message, status = _answer(*words, allowed=(0, 1))
    table = parse_table(printed)
    if "measure" in table.names:
        return Run(table, read_frames(folder) if folder else [])
    if status:
        raise Error(message, status)
    if folder:
        return read_frames(folder)
    return [Frame(int(step), frame["t"][0], frame, None, None) for step, frame in _by_step(table).items()]


def sweep(file, folder, workers=None, replicas=None):
    """Plan a sweep in a folder and make the runs that are not stored yet. Returns its runs as a Table."""
    command("sweep", "plan", file, "-o", folder, *(["--replicas", replicas] if replicas is not None else []))
    command("sweep", "run", folder, *(["-j", workers] if workers is not None else []))
    return read_store(folder)
