"""Reads .kerf files as docs/formats.md describes them, with nothing but Python's own library. Hashes are not checked."""
import array, json, struct

TYPES = {"f8": "d", "f4": "f", "u8": "Q", "u4": "I", "i4": "i", "u2": "H", "u1": "B", "json": "B"}
LITERAL = 2**64 - 1


def aligned(at):
    return (at + 63) // 64 * 64


def read_kerf(path):
    """{section: (dtype, shape, bytes)} of the last commit."""
    data, at, sections = open(path, "rb").read(), 0, {}
    assert data[:9] == b"\x8bKERF\r\n\x1a\n" and struct.unpack_from("<II", data, 12) == (2, 0x01020304)
    while at + 64 <= len(data) and any(data[at:at + 64]):
        table, length = struct.unpack_from("<QQ", data, at + 24)
        end = aligned(table + length) + 64
        if data[end - 64:end - 56] != b"KCOMMIT\n":
            break  # never finished
        for row in json.loads(data[table:table + length]):
            stored = data[row["offset"]:row["offset"] + row["length"]]
            if "runs" in row:
                width = struct.calcsize(TYPES[row["dtype"]])
                for n in row["shape"][1:]:
                    width *= n
                before, given, result = sections[row["name"]][2], 16 * row["runs"], bytearray()
                for source, count in struct.iter_unpack("<QQ", stored[:given]):
                    if source == LITERAL:
                        result += stored[given:given + count * width]
                        given += count * width
                    else:
                        result += before[source * width:(source + count) * width]
                stored = bytes(result)
            sections[row["name"]] = (row["dtype"], row["shape"], stored)
        at = end
    return sections


def numbers(section):
    """The numbers of a section, in order."""
    return array.array(TYPES[section[0]], section[2]).tolist()
