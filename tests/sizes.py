#!/usr/bin/env python3
"""The size of the product: lines, code and semicolons of each room, and the sums of the classes of tests/rooms.txt.

    python3 tests/sizes.py        from the top of the tree

Code is what is neither blank nor a comment; semicolons are those of the code, outside of texts. `reads` is the length of
the project's own headers that a file of the room reads, each once, and `most` is the file that reads most.
"""
import collections
import re

from rooms import CLASSES, KINDS, included, read_rooms, room_of, sources_of

SKIPPED = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.DOTALL)


def measure(path):
    """Lines, lines of code, and semicolons of a file."""
    text = open(path).read()
    code = SKIPPED.sub(lambda found: " " + "\n" * found[0].count("\n") if found[0][0] == "/" else '""', text)
    return text.count("\n"), sum(bool(line.strip()) for line in code.split("\n")), code.count(";")


def reads(path, lengths, seen):
    """Lines of the headers that a file reads, itself left out."""
    total = 0
    for _, target in included(path).values():
        if target and target.endswith(KINDS) and target not in seen:
            seen.add(target)
            total += lengths.setdefault(target, open(target).read().count("\n")) + reads(target, lengths, seen)
    return total


def main():
    rooms = read_rooms("tests/rooms.txt")[0]
    row, lengths = "{:24}{:8}{:>6}{:>8}{:>8}{:>8}{:>8}  {}", {}
    by_room, most = collections.defaultdict(collections.Counter), collections.defaultdict(lambda: (0, ""))
    for path in sources_of(rooms):
        room = room_of(path, rooms)
        for name in (room, rooms[room].kind, "all"):
            by_room[name].update(dict(zip(("files", "lines", "code", "semicolons"), (1, *measure(path)))))
        if path.endswith(".c"):
            most[room] = max(most[room], (reads(path, lengths, {path}), path))
    print(row.format("room", "class", "files", "lines", "code", "semi", "reads", "most"))
    for k, room in enumerate(rooms):
        print(row.format(room.name, room.kind, *by_room[k].values(), most[k][0] or "", most[k][1]).rstrip())
    for name in (*CLASSES, "all"):
        print(row.format(name, "", *by_room[name].values(), "", "").rstrip())


if __name__ == "__main__":
    main()
