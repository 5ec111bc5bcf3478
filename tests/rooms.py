#!/usr/bin/env python3
"""The rooms of the product: includes in one direction, no circle of calls, no crowded folder.

    python3 tests/rooms.py BUILD        from the top of the tree, after the objects in BUILD/obj are made

tests/rooms.txt has the order. A circle is looked for among the objects: one file uses a name, function or data, that
another one defines, so that a circle through descriptors counts too. A name that is exported must be used by another file.
"""
import collections
import glob
import os
import re
import subprocess
import sys

MOST_SOURCES = 20
KINDS = (".c", ".h", ".inl")
CLASSES = ("core", "tool", "papers")


Room = collections.namedtuple("Room", "name module kind")


def read_rooms(path):
    """Rooms in order, and the modules that each module may use."""
    rooms, uses = [], {}
    for line in open(path):
        words = line.split()
        if not words or words[0] == "#":
            continue
        module, name, kind = words[:3]
        if kind not in CLASSES:
            print(f"lint: {path}: {name} has the class {kind}, which is none of {', '.join(CLASSES)}")
            sys.exit(1)
        rooms.append(Room(name, module, kind))
        uses.setdefault(module, set())
        if "<" in words:
            uses[module] |= set(words[words.index("<") + 1:])
    return rooms, uses


def room_of(path, rooms):
    """Index of the room of a file: the file itself where the list names it, with or without its ending, or its folder."""
    names = [room.name for room in rooms]
    for name in (path, os.path.splitext(path)[0], os.path.dirname(path)):
        if name in names:
            return names.index(name)
    return None


def sources_of(rooms):
    """Every file of code in the rooms."""
    return [f"{room.name}/{file}" for room in rooms if os.path.isdir(room.name) for file in sorted(os.listdir(room.name))
            if file.endswith(KINDS)]


def included(path):
    """What a file includes of the project, by line: the text, and the file that it means, or None."""
    found = {}
    for number, line in enumerate(open(path), 1):
        name = re.match(r' *# *include "(.*)"', line)
        if name:
            found[number] = name[1], next((p for p in ("src/" + name[1], name[1]) if os.path.exists(p)), None)
    return found


def wrong_includes(sources, rooms, uses):
    for path in sources:
        own = room_of(path, rooms)
        for number, (name, target) in included(path).items():
            other = room_of(target, rooms) if target else None
            if target and not target.endswith(KINDS):
                continue
            if other is None:
                yield f"{path}:{number}: includes {name}, which is in no room of tests/rooms.txt"
            elif rooms[own].module != rooms[other].module:
                if rooms[other].module not in uses[rooms[own].module]:
                    yield f"{path}:{number}: {rooms[own].module} must not include {name}"
            elif other > own:
                yield f"{path}:{number}: {rooms[own].name} must not include {name}, which stands above it"


def names_of(sources, build):
    """The file that defines each name, and the names that each file uses of others."""
    defines, uses = {}, collections.defaultdict(set)
    paths = {f"{build}/obj/{path[:-2]}.o": path for path in sources if path.endswith(".c")}
    things = [thing for thing in paths if os.path.exists(thing)]
    listed = subprocess.run(["nm", "-A", "-g", *things], capture_output=True, text=True, check=True).stdout if things else ""
    for line in listed.splitlines():
        path = paths[line.split(":")[0]]
        kind, name = line.split()[-2:]
        if kind == "U":
            uses[path].add(name)
        else:
            defines[name] = path
    return defines, uses


def unused(sources, build):
    """Names that no other file uses, nor a test or an example: a descriptor that is in no list, or what should be static."""
    defines, uses = names_of(sources, build)
    more = [path for folder in ("tests", "validation") for path in glob.glob(folder + "/**/*.c", recursive=True)]
    used = set().union(*uses.values(), *names_of(more, build)[1].values(), {"main"})
    for path in glob.glob("examples/*.c"):
        with open(path, encoding="utf-8") as file:
            used |= set(re.findall(r"\w+", file.read()))
    for name, path in defines.items():
        if name not in used:
            yield f"{path}: {name} is used by no other file"


def circles(sources, build):
    """Sets of files that use one another in a circle (Tarjan's strongly connected components)."""
    defines, uses = names_of(sources, build)
    graph = {path: {defines[name] for name in names if name in defines} - {path} for path, names in uses.items()}
    order, low, stack, found = {}, {}, [], []

    def visit(node):
        order[node] = low[node] = len(order)
        stack.append(node)
        for other in graph.get(node, ()):
            if other not in order:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], order[other])
        if low[node] == order[node]:
            part = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(part) > 1:
                found.append(sorted(part))

    sys.setrecursionlimit(10000)
    for node in list(graph):
        if node not in order:
            visit(node)
    return found


def main(build):
    rooms, uses = read_rooms("tests/rooms.txt")
    sources = sources_of(rooms)
    bad = list(wrong_includes(sources, rooms, uses))
    bad += ["these files use one another in a circle: " + " ".join(part) for part in circles(sources, build)]
    bad += unused(sources, build)
    for folder, count in collections.Counter(os.path.dirname(p) for p in sources if p.endswith(".c")).items():
        if count > MOST_SOURCES:
            bad.append(f"{folder} has {count} .c files, more than {MOST_SOURCES}")
    for line in bad:
        print("lint:", line)
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
