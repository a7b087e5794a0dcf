#!/usr/bin/env python3
"""Writes crates/phugoid-flight-data/src/mavlink/messages.txt: every message of MAVLink's `ardupilotmega` dialect (which contains
`common`), from pymavlink's generated definitions. Run: pip install pymavlink==2.4.50; scripts/make-mavlink-definitions.py"""
import pathlib
import warnings

from pymavlink.dialects.v20 import ardupilotmega

warnings.simplefilter("ignore")
TYPES = {"uint8_t_mavlink_version": "u8", "uint8_t": "u8", "int8_t": "i8", "uint16_t": "u16", "int16_t": "i16", "uint32_t": "u32",
         "int32_t": "i32", "uint64_t": "u64", "int64_t": "i64", "float": "f32", "double": "f64", "char": "char"}
lines = ["# Message definitions of MAVLink, dialect ardupilotmega with common (https://mavlink.io, MIT licence), written from pymavlink",
         "# 2.4.50 by scripts/make-mavlink-definitions.py. One message per line: id, name, CRC_EXTRA, then its fields in the order of the",
         "# wire as name:type:count:unit (count 0: a single value, no array; unit as MAVLink writes it, may be empty)."]
for number, message in sorted(ardupilotmega.mavlink_map.items()):
    fields = []
    for name in message.ordered_fieldnames:
        index = message.fieldnames.index(name)
        kind = TYPES[message.fieldtypes[index]]
        count = message.array_lengths[message.ordered_fieldnames.index(name)]
        fields.append(f"{name}:{kind}:{count}:{message.fieldunits_by_name.get(name, '')}")
    lines.append(" ".join([str(number), message.msgname, str(message.crc_extra), *fields]))
target = pathlib.Path(__file__).parent.parent / "crates/phugoid-flight-data/src/mavlink/messages.txt"
target.write_text("\n".join(lines) + "\n")
