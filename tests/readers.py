"""What `repose export` writes, read back by other programs. Usage: readers.py CASE, in a folder that the suite
`export` has filled. The tables of the run are read here by themselves; a number must have the same bits. The
cases light and package need the standard library alone; vtk, pandas and lammps those programs.
"""
import csv
import json
import math
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as xml

COMPONENTS = {"radius": ["r"], "mass": ["m"], "omegaz": ["omega"], "velocity": ["vx", "vy"],
              "force": ["fx", "fy"]}


def number(text):
    return {"infinite": math.inf}.get(text) or float(text)


def table(path):
    """Rows of a table as dictionaries of texts."""
    lines = [line.rstrip("\n") for line in open(path)]
    data = [line for line in lines if not line.startswith("#")]
    if data and re.match("[a-z]", data[0]):
        names, data = data[0], data[1:]
    else:
        names = [line for line in lines if line.startswith("#")][-1][2:]
    return [dict(zip(names.split("\t"), line.split("\t"))) for line in data]


def frames(path):
    """Rows of each step, in order."""
    parts = {}
    for row in table(path):
        parts.setdefault(int(number(row["step"])), []).append({k: number(v) for k, v in row.items()})
    return parts


def same(a, b, what):
    assert a == b or (a != a and b != b), f"{what}: {a} for {b}"


def same_rows(found, expected, what):
    assert len(found) == len(expected), f"{what}: {len(found)} rows for {len(expected)}"
    for i, (a, b) in enumerate(zip(found, expected)):
        for name, value in a.items():
            same(value, b[name], f"{what}, row {i}, {name}")


# ---- formats by the standard library

def dump_frames(path):
    """(step, time, box, rows of numbers by name) of a LAMMPS dump, ATOMS or ENTRIES."""
    lines = open(path).read().split("\n")
    found, at = [], 0
    while lines[at]:
        assert lines[at] == "ITEM: TIME" and lines[at + 2] == "ITEM: TIMESTEP"
        time, step, n = float(lines[at + 1]), int(lines[at + 3]), int(lines[at + 5])
        assert re.match("ITEM: NUMBER OF (ATOMS|ENTRIES)$", lines[at + 4])
        assert lines[at + 6] == "ITEM: BOX BOUNDS ff ff pp"
        box = [[float(word) for word in lines[at + k].split()] for k in (7, 8, 9)]
        names = lines[at + 10].split()[2:]
        rows = [dict(zip(names, map(float, line.split()))) for line in lines[at + 11:at + 11 + n]]
        assert all(len(line.split()) == len(names) for line in lines[at + 11:at + 11 + n])
        found.append((step, time, box, rows))
        at += 11 + n
    return found


def light_dump(states, contacts):
    found = dump_frames("pile.lammpstrj")
    assert [f[0] for f in found] == list(states), "steps of the dump"
    for step, time, box, rows in found:
        expected = states[step]
        same(time, expected[0]["t"], "time")
        for row in rows:
            assert row.pop("type") == 1 and row.pop("z") == row.pop("vz") == row.pop("fz") == 0
            assert box[0][0] <= row["x"] - row["radius"] and row["x"] + row["radius"] <= box[0][1]
            assert box[1][0] <= row["y"] - row["radius"] and row["y"] + row["radius"] <= box[1][1]
            assert box[2][0] <= -row["radius"]
            for name in ("radius", "mass", "omegaz"):
                row[COMPONENTS[name][0]] = row.pop(name)
            assert len(row) == len(expected[0]) - 2
        same_rows(rows, expected, f"dump, step {step}")
    found = dump_frames("pile.contacts.lammpstrj")
    assert [f[0] for f in found] == list(states), "steps of the contacts"
    for step, time, box, rows in found:
        same_rows(rows, contacts.get(step, []), f"contacts, step {step}")
        assert all(len(row) == len(contacts[step][0]) - 2 for row in rows)
    few = dump_frames("few.lammpstrj")
    assert [f[0] for f in few] == [s for s in states if s >= 500], "--where"
    assert list(few[0][3][0]) == ["id", "type", "x", "y", "z", "radius", "contacts"], "--columns"


def vtp(path):
    """Points, cells and arrays of PolyData, by the library of XML."""
    piece = xml.parse(path).getroot().find("PolyData/Piece")

    def array(element, kind=float):
        return [kind(word) for word in (element.text or "").split()]

    def rows(element):
        flat, width = array(element), int(element.get("NumberOfComponents"))
        return [flat[i:i + width] for i in range(0, len(flat), width)]

    cells = piece.find("Verts") if piece.find("Verts") is not None else piece.find("Lines")
    ids, ends = (array(e, int) for e in cells.findall("DataArray"))
    data = piece.find("PointData") if piece.find("PointData") is not None else piece.find("CellData")
    points = rows(piece.find("Points/DataArray"))
    counts = {"Points": len(points), "Verts": 0, "Lines": 0, "Strips": 0, "Polys": 0, cells.tag: len(ends)}
    assert piece.attrib == {"NumberOf" + kind: str(n) for kind, n in counts.items()}, "numbers of cells"
    assert sorted(ids) == list(range(len(points))) and len(ids) == (ends or [0])[-1], "points of cells"
    return points, [ids[a:b] for a, b in zip([0] + ends, ends)], {e.get("Name"): rows(e) for e in data}


def check_poly(points, cells, data, name, expected, contacts, box):
    """A part of a frame against the rows of its table."""
    if name == "grains":
        assert cells == [[i] for i in range(len(expected))], "vertices"
        found = [{"x": p[0], "y": p[1]} for p in points]
    else:
        assert cells == [[2 * i, 2 * i + 1] for i in range(len(expected))], "lines"
        found = [{} for _ in expected]
    if name == "contacts":
        found = [{"x": a[0], "y": a[1], "x_b": b[0], "y_b": b[1]} for a, b in zip(points[0::2], points[1::2])]
    if name == "walls":
        for a, b, w in zip(points[0::2], points[1::2], expected):
            tangent = (w["direction_y"], -w["direction_x"])
            for point, end in ((a, w["from"]), (b, w["to"])):
                along = sum((p - o) * t for p, o, t in zip(point, (w["x"], w["y"]), tangent))
                across = (point[0] - w["x"]) * w["direction_x"] + (point[1] - w["y"]) * w["direction_y"]
                assert abs(across) < 1e-12 and (math.isinf(end) or abs(along - end) < 1e-12), "wall"
                # an open end is beyond every grain
                corners = [(x - w["x"]) * tangent[0] + (y - w["y"]) * tangent[1] for x in box[0] for y in box[1]]
                if math.isinf(end):
                    assert abs(along - (max if end > 0 else min)(corners)) < 1e-12, "open end"
    assert all(p[2] == 0 for p in points)
    for array, values in data.items():
        for row, value in zip(found, values):
            row.update(zip(COMPONENTS.get(array, [array]), value))
    placed = {"grains": 2, "contacts": 2, "walls": 8}[name]
    assert all(len(row) == len(expected[0]) - placed for row in found), "arrays of " + name
    same_rows(found, expected, name)


def check_vtk(states, contacts, walls, read):
    box = dump_frames("pile.lammpstrj")[0][2]
    sets = xml.parse("pile.pvd").getroot().findall("Collection/DataSet")
    assert len(sets) == 3 * len(states), "parts of the collection"
    for i, part in enumerate(sets):
        step = list(states)[i // 3]
        name = ("grains", "contacts", "walls")[i % 3]
        assert part.get("name") == name and part.get("part") == str(i % 3)
        same(float(part.get("timestep")), states[step][0]["t"], "time")
        expected = (states, contacts, walls)[i % 3].get(step, [])
        if name == "walls":
            assert len(expected) == 3
        check_poly(*read(part.get("file")), name, expected, contacts, box)


def light_tables():
    expected = table("pile/states.tsv")
    rows = list(csv.reader(open("pile.csv", newline="")))
    assert rows[0] == list(expected[0]) and rows[1:] == [list(row.values()) for row in expected], "csv"
    pile = json.load(open("pile.json"))
    assert pile["notes"]["program"].startswith("repose") and "units" not in pile["notes"]
    assert list(pile["units"]) == list(expected[0]) and pile["units"]["vx"] not in ("", "1")
    same_rows(pile["rows"], [{k: number(v) for k, v in row.items()} for row in expected], "json")
    assert [list(row) for row in pile["rows"]] == [list(row) for row in expected]
    words = json.load(open("words.json"))["rows"]
    assert words == [{"a": 1.5, "b": None, "c": "infinite"}, {"a": -2e-300, "b": 0.5, "c": 'x"y,z'}], words
    assert open("words.csv", newline="").read() == 'a,b,c\n1.5,nan,infinite\n-2e-300,.5,"x""y,z"\n'


def light():
    states, contacts, walls = (frames(f"pile/{name}.tsv") for name in ("states", "contacts", "walls"))
    assert len(states) == 5 and 0 < len(contacts) < 5 and len({len(rows) for rows in states.values()}) > 1, "the scene"
    light_dump(states, contacts)
    check_vtk(states, contacts, walls, vtp)
    light_tables()


def sweep():
    """Runs and points of a sweep, against its own table."""
    expected = table("runs.tsv")
    rows = list(csv.DictReader(open("runs.csv", newline="")))
    assert len(rows) == len(expected) == 4
    for row, wanted in zip(rows, expected):
        assert all(row[name] == cell for name, cell in wanted.items()), "a run"
        assert float(row["W"]) == 1 and row["floor"] and len(row) > len(wanted), "parameters"
    points = json.load(open("points.json"))["rows"]
    assert [p["mu"] for p in points] == [0.1, 0.3] and all(p["n"] + p["n_failed"] == 2 for p in points)
    assert all(p["W"] == 1 for p in points)


# ---- other programs

def vtk():
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    def read(path):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(path)
        reader.Update()
        poly = reader.GetOutput()
        points = [poly.GetPoint(i) for i in range(poly.GetNumberOfPoints())]
        cells = [[poly.GetCell(i).GetPointId(k) for k in range(poly.GetCell(i).GetNumberOfPoints())]
                 for i in range(poly.GetNumberOfCells())]
        data = poly.GetPointData() if poly.GetPointData().GetNumberOfArrays() else poly.GetCellData()
        arrays = {}
        for k in range(data.GetNumberOfArrays()):
            values = vtk_to_numpy(data.GetArray(k))
            arrays[data.GetArrayName(k)] = values.reshape(len(values), -1).tolist() if len(values) else []
        return points, cells, arrays

    check_vtk(*(frames(f"pile/{name}.tsv") for name in ("states", "contacts", "walls")), read)


def pandas():
    import pandas

    expected = table("pile/states.tsv")
    for found in (pandas.read_csv("pile.csv"), pandas.DataFrame(json.load(open("pile.json"))["rows"])):
        assert list(found.columns) == list(expected[0]) and len(found) == len(expected)
        for name in found.columns:
            # the fast parser of read_csv is off by up to 3e-13 here; round_trip below is not
            assert all(abs(a - number(row[name])) <= 1e-12 * abs(a) for a, row in zip(found[name], expected)), name
    exact = pandas.read_csv("pile.csv", float_precision="round_trip")
    assert all(exact[name][i] == number(row[name]) for i, row in enumerate(expected) for name in row)
    words = pandas.read_csv("words.csv")
    assert words["a"][1] == -2e-300 and words["b"].isna()[0] and words["c"][1] == 'x"y,z'
    import_repose()
    import repose

    frame = repose.read_frames("pile")[-1].grains.dataframe()
    assert list(frame.columns) == list(expected[0]) and frame["x"].iloc[-1] == float(expected[-1]["x"])


def lmp(text):
    """Standard output of LAMMPS with this input."""
    with open("input", "w") as file:
        file.write(text)
    root = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1")
    done = subprocess.run(["lmp", "-in", "input", "-log", "none"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, env=root)
    assert done.returncode == 0, done.stdout
    return done.stdout


def lammps():
    """read_dump of every frame, written again; and rerun, which takes them in turn."""
    states = frames("pile/states.tsv")
    first, last = list(states)[0], list(states)[-1]
    text = ("units lj\ndimension 2\natom_style sphere\natom_modify map array\nboundary f f p\n"
            "region all block -99 99 -99 99 -1 1\ncreate_box 1 all\npair_style zero 1.0\npair_coeff * *\n")
    for step in states:
        text += (f"read_dump pile.lammpstrj {step} x y vx vy box yes purge yes replace no add keep\n"
                 f"write_dump all custom again.{step} id x y vx vy modify sort id format float %.17g\n")
    text += (f"thermo_style custom step atoms\nthermo 1\n"
             f"rerun pile.lammpstrj first {first} last {last} dump x y box yes purge yes replace no add keep\n")
    said = lmp(text)
    for step, expected in states.items():
        lines = open(f"again.{step}").read().split("\n")
        at = next(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
        names = ["id", "x", "y", "vx", "vy"]
        rows = [dict(zip(names, map(float, line.split()))) for line in lines[at + 1:] if line]
        same_rows(rows, sorted(expected, key=lambda row: row["id"]), f"read_dump, step {step}")
    thermo = [line.split() for line in said[said.index("Step Atoms"):].split("\n")[1:1 + len(states)]]
    assert [[int(w) for w in words] for words in thermo] == [[s, len(states[s])] for s in states], thermo


def scene(name, tolerance):
    """The last frame of `lmp` on NAME.in against the run in NAME, over the largest radius."""
    with open(f"{name}.in") as file:
        lmp("variable every index 1000\n" + file.read())
    lines = open(f"{name}.lammpstrj").read().split("\n")
    at = max(i for i, line in enumerate(lines) if line.startswith("ITEM: TIMESTEP"))
    assert int(lines[at + 1]) == 1000
    names = lines[at + 8].split()[2:]
    found = {int(row["id"]): row for row in
             (dict(zip(names, map(float, line.split()))) for line in lines[at + 9:] if line)}
    ours = frames(f"{name}/states.tsv")[1000]
    assert len(found) == len(ours)
    largest = max(row["r"] for row in ours)
    off = max(max(abs(found[row["id"]][k] - row[k]) for k in "xy") for row in ours) / largest
    moved = max(abs(row["vx"]) + abs(row["vy"]) for row in ours)
    print(f"{name}: {len(ours)} grains, largest difference {off:.2g} radii", file=sys.stderr)
    assert moved > 0 and off < tolerance, f"{name}: positions differ by {off:.3g} radii"


def lammps_input():
    for name in sys.argv[2:]:
        scene(name, 1e-8)


# ---- python/repose.py

def import_repose():
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "python"))


def random():
    """Names and units of random.tsv are those of its CSV and JSON, and are words in the formats of grains."""
    texts = open("names", newline="\n").read().split("\n")[:-1]
    units, names = texts[:len(texts) // 2], texts[len(texts) // 2:]
    rows = list(csv.reader(open("random.csv", newline="")))
    found = json.load(open("random.json"))
    assert rows[0][4:] == names and len(rows) == 3, (rows[0][4:], names)
    assert list(found["units"])[4:] == names and list(found["units"].values())[4:] == units, (found["units"], units)
    words = [re.sub("[^a-zA-Z0-9._+/()\\[\\]\\x80-\\U0010ffff-]", "_", name) for name in names]
    os.chdir("made")
    for path in os.listdir("."):
        if path.endswith(".lammpstrj"):
            head = next(line for line in open(path) if line.startswith("ITEM: ATOMS "))
            assert head.split()[-len(words):] == words
        elif path.endswith(".pvd"):
            if min(path) >= " ":
                for data in xml.parse(path).getroot().iter("DataSet"):
                    arrays = xml.parse(data.get("file")).getroot().iter("DataArray")
                    assert [a.get("Name") for a in arrays if a.get("Name").startswith("c") and a.get("Name") != "connectivity"] == words
        elif path.endswith(".in"):
            assert re.fullmatch("[a-zA-Z0-9._+()\\[\\]\\x80-\\U0010ffff-]*", path), path
            assert not any("touch" in line for line in open(path) if not line.startswith("#")) or "touch" in path


def package():
    import_repose()
    import repose

    states, contacts, walls = (frames(f"pile/{name}.tsv") for name in ("states", "contacts", "walls"))
    found = repose.read_frames("pile")
    assert [f.step for f in found] == list(states)
    for frame in found:
        for part, expected in ((frame.grains, states), (frame.contacts, contacts), (frame.walls, walls)):
            rows = expected.get(frame.step, [])
            assert len(part) == len(rows)
            same_rows([dict(zip(part.names, map(number, row))) for row in part.rows], rows, "a frame")
        same(frame.t, states[frame.step][0]["t"], "t")
    assert found[0].grains.units["vx"] not in ("", "1") and found[0].grains.notes["program"].startswith("repose")
    whole, late = repose.run("e.cfg", n=20), repose.run("e.cfg", "late", every=10, n=60)
    assert (whole.status, whole.measures, whole.units, whole.frames) == ("ok", {"n_steps": 20.0}, {"n_steps": "steps"}, [])
    assert whole.let == {"n": 20.0}
    assert late.status == "late" and late.measures["n_steps"] != late.measures["n_steps"] and "step > 45" in late.message
    assert [f.step for f in late.frames] == [0, 10, 20, 30, 40, 50]
    again = repose.run("scene.cfg", "again", every=250, set={"tangential.mu": 0.1, "ledger": True})
    assert [f.step for f in again] == list(states)
    assert any(a != b for a, b in zip(again[-1].grains["x"], found[-1].grains["x"])), "set"
    gone = "leaves \u2028 \x85 \udcff.cfg"  # in a name no line ends, and what is no UTF-8 stays
    with open(gone, "w") as file:
        file.write("dt = 1e-4; y_min = -0.004; steps = 40; output = { states = 20; energy = 10; contacts = 0; walls = 0; };"
                   "particles = ( { x = 0.0; y = 0.0; r = 0.1; vy = -1.0; } );")
    left = repose.run(gone, "left")
    assert [(f.step, f.t, len(f.grains)) for f in left] == [(0, 0, 1), (20, 0.002, 1), (30, 0.003, 0), (40, 0.004, 0)]
    printed = repose.run(gone)  # frames by their steps
    assert [(f.step, len(f.grains)) for f in printed] == [(0, 1), (20, 1)] and "\u2028" in printed[0].grains.notes["command"]
    try:
        repose.run("scene.cfg", "none", every=0)
    except repose.Error as error:
        assert "--every = 0" in str(error), error
    else:
        raise AssertionError("every=0")
    runs, expected = repose.sweep("sweep.cfg", "s", workers=1), table("runs.tsv")
    assert list(runs["status"]) == [row["status"] for row in expected]
    assert [float(v) for v in runs["theta_r3_deg"]] == [number(row["theta_r3_deg"]) for row in expected] or any(
        v != v for v in runs["theta_r3_deg"])
    assert list(runs["mu"]) == [0.1, 0.1, 0.3, 0.3] and list(runs["W"]) == 4 * [1]
    assert runs.units["theta_r3_deg"] == "degree" and runs.notes["missing"] == "0 of 4"
    assert runs["theta_t"] == 4 * [False]
    some = runs.where("mu", 0.3)
    assert some.names == runs.names and some.rows == runs.rows[2:] and some.units == runs.units and len(some) == 2
    assert some.notes == runs.notes and len(runs.where("mu", 0.2)) == 0
    assert runs.where("status", runs["status"][3]).rows == [r for r in runs.rows if r[1] == runs.rows[3][1]]
    assert repose.read_store("first/store.sqlite").rows[1] == repose.read_store("first").rows[1]
    part = repose.read_store("part")  # one shard of two, not merged
    assert list(part["run"]) == [1, 3] and part.notes["missing"] == "2 of 4"
    assert list(part["theta_r3_deg"]) == list(runs["theta_r3_deg"])[1::2]
    with open("part/shards/2-of-2.sqlite", "w") as store:
        store.write("no database")
    try:
        repose.read_store("part")
    except repose.Error as error:
        assert error.status == 74 and "file is not a database" in str(error), error
    else:
        raise AssertionError("a damaged store is read")
    tilt = repose.command("angle", "tilt", "--mu", 0.2, "--theta-r-deg", 18)
    assert abs(tilt["theta_t_deg"][0] - 4.834) < 1e-3 and tilt["status"] == ["ok"]
    os.chdir("part")  # the folder that one is in is not meant by a name that is not there
    for name in "typo", "../first/typo":
        try:
            repose.read_store(name)
        except repose.Error as error:
            assert "typo" in str(error), error
        else:
            raise AssertionError(name)
    os.chdir("..")
    for wrong, status in ((("run", "nowhere.cfg"), 65), (("angle", "tilt"), 64)):
        try:
            repose.command(*wrong)
        except repose.Error as error:
            assert error.status == status and str(error).startswith("repose"), error
        else:
            raise AssertionError(wrong)


CASES = {f.__name__: f for f in (light, sweep, vtk, pandas, lammps, lammps_input, package, random)}
CASES[sys.argv[1]]()
