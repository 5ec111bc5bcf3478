#!/usr/bin/env python3
"""The rooms of the product: includes in one direction, no circle of calls, no crowded folder.

    python3 tests/rooms.py BUILD        from the top of the tree, after the objects in BUILD/obj are made

tests/rooms.txt has the order. A circle is looked for among the objects: one file uses a name, function or data, that
another one defines, so that a circle through descriptors counts too.
"""
import collections
import os
import re
import subprocess
import sys

MOST_SOURCES = 20
KINDS = (".c", ".h", ".inl")


def read_rooms(path):
    """Rooms in order as (folder or file, module), and the modules that each module may use."""
    rooms, uses = [], {}
    for line in open(path):
        words = line.split()
        if not words or words[0] == "#":
            continue
        rooms.append((words[1], words[0]))
        uses.setdefault(words[0], set())
        if "<" in words:
            uses[words[0]] |= set(words[words.index("<") + 1:])
    return rooms, uses


def room_of(path, rooms):
    """Index of the room of a file: its folder, or the file itself where the list names it."""
    names = [name for name, _ in rooms]
    for name in (path, os.path.dirname(path)):
        if name in names:
            return names.index(name)
    return None


def wrong_includes(sources, rooms, uses):
    for path in sources:
        own = room_of(path, rooms)
        for number, line in enumerate(open(path), 1):
            found = re.match(r' *#include "(.*)"', line)
            if not found:
                continue
            target = next((p for p in ("src/" + found[1], found[1]) if os.path.exists(p)), None)
            other = room_of(target, rooms) if target else None
            if target and not target.endswith(KINDS):
                continue
            if other is None:
                yield f"{path}:{number}: includes {found[1]}, which is in no room of tests/rooms.txt"
            elif rooms[own][1] != rooms[other][1]:
                if rooms[other][1] not in uses[rooms[own][1]]:
                    yield f"{path}:{number}: {rooms[own][1]} must not include {found[1]}"
            elif other > own:
                yield f"{path}:{number}: {rooms[own][0]} must not include {found[1]}, which stands above it"


def circles(sources, build):
    """Sets of files that use one another in a circle (Tarjan's strongly connected components)."""
    defines, uses = {}, collections.defaultdict(set)
    for path in sources:
        thing = f"{build}/obj/{path[:-2]}.o"
        if path.endswith(".c") and os.path.exists(thing):
            for line in subprocess.run(["nm", "-g", thing], capture_output=True, text=True, check=True).stdout.splitlines():
                kind, name = line.split()[-2:]
                if kind == "U":
                    uses[path].add(name)
                else:
                    defines[name] = path
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
    sources = [f"{name}/{file}" for name, _ in rooms if os.path.isdir(name) for file in sorted(os.listdir(name))
               if file.endswith(KINDS)]
    bad = list(wrong_includes(sources, rooms, uses))
    bad += ["these files use one another in a circle: " + " ".join(part) for part in circles(sources, build)]
    for folder, count in collections.Counter(os.path.dirname(p) for p in sources if p.endswith(".c")).items():
        if count > MOST_SOURCES:
            bad.append(f"{folder} has {count} .c files, more than {MOST_SOURCES}")
    for line in bad:
        print("lint:", line)
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
