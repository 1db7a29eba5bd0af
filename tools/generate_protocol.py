#!/usr/bin/env python3
"""Write the Python and TypeScript that follow from protocol/schema. `--check` only compares.

Both outputs are committed; a test runs this with --check, so the schema stays the single source.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
SCHEMA = ROOT / "protocol" / "schema"
PYTHON = ROOT / "fapstream" / "protocol" / "generated.py"
TYPESCRIPT = ROOT / "clients" / "web" / "src" / "protocol" / "generated.ts"
SPEC = ROOT / "protocol" / "SPEC.md"
FAPS = ROOT / "fapstream" / "fap" / "data" / "faps.json"

PY_TYPES = {
    "int": "int", "str": "str", "bool": "bool", "text": "bytes", "u8": "bytes", "i16": "NDArray[np.int16]", "i32": "NDArray[np.int32]",
}  # fmt: skip
TS_TYPES = {
    "int": "number", "str": "string", "bool": "boolean", "text": "Uint8Array", "u8": "Uint8Array",
    "i16": "Int16Array", "i32": "Int32Array",
}  # fmt: skip

Field = dict[str, Any]


def load(name: str) -> Any:
    return json.loads((SCHEMA / f"{name}.json").read_text(encoding="utf-8"))


def camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def py_type(field: Field) -> str:
    if field["type"] == "list":
        return f"tuple[{PY_TYPES.get(field['of'], camel(field['of']))}, ...]"
    if "enum" in field:
        return f"Literal[{', '.join(map(json.dumps, field['enum']))}]"
    return PY_TYPES[field["type"]]


def ts_type(field: Field) -> str:
    if field["type"] == "list":
        return f"{TS_TYPES.get(field['of'], camel(field['of']))}[]"
    if "enum" in field:
        return " | ".join(map(json.dumps, field["enum"]))
    return TS_TYPES[field["type"]]


def py_class(name: str, doc: str, fields: list[Field], type_name: str | None) -> str:
    lines = [
        "@dataclass(frozen=True, slots=True, kw_only=True)",
        f"class {camel(name)}:",
        f'    """{doc}"""',
        "",
    ]
    if type_name:
        lines += [f'    type: ClassVar[str] = "{type_name}"']
    for f in fields:
        kind = py_type(f)
        lines.append(
            f"    {f['name']}: {kind} | None = None" if f.get("optional") else f"    {f['name']}: {kind}"
        )
        lines.append(f'    """{f["doc"]}"""')
    return "\n".join(lines) + "\n"


def spec(fields: list[Field]) -> list[Field]:
    """The fields as the codecs read them: everything but the prose."""
    return [{k: v for k, v in f.items() if k != "doc"} for f in fields]


def ephemeral(messages: list[Any]) -> list[str]:
    return [m["name"] for m in messages if m.get("ephemeral")]


def py_literal(value: Any) -> str:
    """A field spec as constructor text."""
    parts = []
    for key, item in value.items():
        item = tuple(item) if isinstance(item, list) else item
        parts.append(f"{key}={item!r}".replace("'", '"'))
    return f"FieldSpec({', '.join(parts)})"


def python_source(messages: Any, session: Any, errors: Any) -> str:
    structs, msgs = messages["structs"], messages["messages"]
    out = [
        '"""Generated from protocol/schema by tools/generate_protocol.py. Do not edit."""\n',
        "# ruff: noqa: E501\nfrom __future__ import annotations\n",
        "from dataclasses import dataclass",
        "from typing import ClassVar, Literal\n",
        "import numpy as np\nfrom numpy.typing import NDArray\n",
        f'SUBPROTOCOL = "{messages["subprotocol"]}"',
    ]
    out += [f"{key.upper()} = {value}" for key, value in messages["limits"].items()]
    out.append(PY_FIELD_SPEC)
    out += [
        py_class(name, f"Part of a message: {name}.", fields, None) + "\n" for name, fields in structs.items()
    ]
    out += [py_class(m["name"], m["doc"], m["fields"], m["name"]) + "\n" for m in msgs]
    for side in ("client", "server"):
        names = " | ".join(camel(m["name"]) for m in msgs if m["from"] in (side, "both"))
        out.append(f"{side.capitalize()}Message = {names}")
    out.append("Message = ClientMessage | ServerMessage\n")
    out.append("STRUCTS: dict[str, tuple[type, tuple[FieldSpec, ...]]] = {")
    out += [f'    "{n}": ({camel(n)}, ({", ".join(map(py_literal, spec(f)))},)),' for n, f in structs.items()]
    out.append("}\n\nMESSAGES: dict[str, tuple[type[Message], str, tuple[FieldSpec, ...]]] = {")
    for m in msgs:
        fields = ", ".join(map(py_literal, spec(m["fields"])))
        out.append(
            f'    "{m["name"]}": ({camel(m["name"])}, "{m["from"]}", ({fields}{"," if fields else ""})),'
        )
    out.append("}\n")
    out.append(f"EPHEMERAL = frozenset({json.dumps(ephemeral(msgs))})")
    out.append('"""Messages that are not counted and not sent again after a lost connection."""\n')
    for table in ("session", "turn"):
        for side in ("client", "server"):
            body = json.dumps(session[table][side], indent=4)
            out.append(f"{table.upper()}_{side.upper()}: dict[str, dict[str, str]] = {body}\n")
    fatal = {e["code"]: e["fatal"] for e in errors}
    out.append("ERRORS: dict[str, bool] = {")
    out += [f'    "{code}": {is_fatal},' for code, is_fatal in fatal.items()]
    out.append('}\n"""Error code -> whether the session ends."""')
    return "\n".join(out) + "\n"


PY_FIELD_SPEC = '''

@dataclass(frozen=True, slots=True)
class FieldSpec:
    """What the codec checks of one field; see protocol/SPEC.md for the types."""

    name: str
    type: str
    optional: bool = False
    min: int | None = None
    max: int | None = None
    enum: tuple[str | int, ...] = ()
    of: str = ""

'''


def typescript_source(messages: Any, session: Any, errors: Any) -> str:
    structs, msgs = messages["structs"], messages["messages"]
    out = ["// Generated from protocol/schema by tools/generate_protocol.py. Do not edit.\n"]
    out.append(f'export const SUBPROTOCOL = "{messages["subprotocol"]}";')
    out.append(f"export const LIMITS = {json.dumps(messages['limits'], indent=2)} as const;\n")
    out.append(TS_FIELD_SPEC)
    for name, fields in structs.items():
        out.append(ts_interface(name, f"Part of a message: {name}.", fields, None))
    for m in msgs:
        out.append(ts_interface(m["name"], m["doc"], m["fields"], m["name"]))
    for side in ("client", "server"):
        names = " | ".join(camel(m["name"]) for m in msgs if m["from"] in (side, "both"))
        out.append(f"export type {side.capitalize()}Message = {names};")
    out.append("export type Message = ClientMessage | ServerMessage;\n")
    out.append(
        f"export const STRUCTS: Record<string, FieldSpec[]> = {ts_json({n: spec(f) for n, f in structs.items()})};\n"
    )
    table = {m["name"]: {"from": m["from"], "fields": spec(m["fields"])} for m in msgs}
    out.append(
        f"export const MESSAGES: Record<string, {{ from: string; fields: FieldSpec[] }}> = {ts_json(table)};\n"
    )
    out.append("/** Messages that are not counted and not sent again after a lost connection. */")
    out.append(f"export const EPHEMERAL: ReadonlySet<string> = new Set({json.dumps(ephemeral(msgs))});\n")
    for name in ("session", "turn"):
        for side in ("client", "server"):
            out.append(
                f"export const {name.upper()}_{side.upper()}: Record<string, Record<string, string>> = "
                f"{ts_json(session[name][side])};\n"
            )
    out.append(
        f"export const ERRORS: Record<string, boolean> = {ts_json({e['code']: e['fatal'] for e in errors})};"
    )
    return "\n".join(out) + "\n"


TS_FIELD_SPEC = """export interface FieldSpec {
  name: string;
  type: "int" | "str" | "bool" | "text" | "u8" | "i16" | "i32" | "list";
  optional?: boolean;
  min?: number;
  max?: number;
  enum?: (string | number)[];
  of?: string;
}
"""


def ts_json(value: Any) -> str:
    return json.dumps(value, indent=1)


def ts_interface(name: str, doc: str, fields: list[Field], type_name: str | None) -> str:
    lines = [f"/** {doc} */", f"export interface {camel(name)} {{"]
    if type_name:
        lines.append(f'  type: "{type_name}";')
    for f in fields:
        lines.append(f"  /** {f['doc']} */")
        lines.append(f"  {f['name']}{'?' if f.get('optional') else ''}: {ts_type(f)};")
    return "\n".join(lines) + "\n}\n"


def spec_tables(messages: Any) -> str:
    """The message tables of SPEC.md."""
    out = []
    for m in messages["messages"]:
        arrow = {"client": "client → server", "server": "server → client", "both": "either way"}[m["from"]]
        out += [f"### `{m['name']}` ({arrow})", "", m["doc"], "", *field_table(m["fields"])]
        out += ["", "Example:", "", f"    {example(m['name'])}"]
        out += ["", "Not counted (4.3)."] if m.get("ephemeral") else []
        out += ["", f"> Why? {m['why']}"] if "why" in m else []
        out.append("")
    for name, fields in messages["structs"].items():
        out += [f"### Part: `{name}`", "", *field_table(fields), ""]
    return "\n".join(out)


def example(name: str) -> str:
    """The fullest golden message of that type, as in protocol/vectors/messages.json."""
    cases = json.loads((ROOT / "protocol" / "vectors" / "messages.json").read_text(encoding="utf-8"))
    messages = [c["message"] for c in cases if c["message"]["type"] == name]
    return max((json.dumps(m, ensure_ascii=False) for m in messages), key=len)


def field_table(fields: list[Field]) -> list[str]:
    rows = ["| field | type | | meaning |", "|---|---|---|---|"]
    for f in fields:
        kind = f"list of {f['of']}" if f["type"] == "list" else f["type"]
        limits = " or ".join(f"`{e}`" for e in f["enum"]) if "enum" in f else limit_text(f)
        need = "optional" if f.get("optional") else "required"
        rows.append(f"| `{f['name']}` | {kind} | {', '.join(filter(None, [need, limits]))} | {f['doc']} |")
    return rows


def limit_text(field: Field) -> str:
    if "min" in field and "max" in field:
        return f"{field['min']} to {field['max']}"
    if "min" in field:
        return f"at least {field['min']}"
    return f"at most {field['max']}" if "max" in field else ""


def spec_source(messages: Any) -> str:
    head, rest = SPEC.read_text(encoding="utf-8").split("<!-- generated: messages -->\n")
    tail = rest[rest.index("<!-- end -->") :]
    return f"{head}<!-- generated: messages -->\n{spec_tables(messages)}{tail}"


def outputs() -> dict[Path, str]:
    messages, session, errors = load("messages"), load("session"), load("errors")
    return {
        PYTHON: python_source(messages, session, errors),
        TYPESCRIPT: typescript_source(messages, session, errors),
        SPEC: spec_source(messages),
        FAPS: (SCHEMA / "faps.json").read_text(encoding="utf-8"),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="change nothing; fail if anything would change")
    check = parser.parse_args().check
    stale = [p for p, text in outputs().items() if not p.exists() or p.read_text(encoding="utf-8") != text]
    for path in stale:
        print(("stale: " if check else "wrote: ") + str(path.relative_to(ROOT)))
        if not check:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(outputs()[path], encoding="utf-8")
    return int(check and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
