#!/usr/bin/env python3
"""Asks the questions of docs/fleet.md of a store of a fleet and of one of a campaign, with DuckDB.

Each must be answered by rows, of at least one of the two stores; the columns of the store must be those of the document; and
what the questions count must be what the fleet is known to have: 14 logs, of which two are refused.
"""

import re
import sys

import duckdb


def answers(questions: list[str], store: str) -> list[list[tuple]]:
    database = duckdb.connect()
    results = []
    for question in questions:
        question = question.replace("'fleet/", f"'{store}/")
        if "FROM read_parquet" in question and "/logs/" in question and not duckdb.sql(f"FROM glob('{store}/logs/**')").fetchall():
            # A campaign has no logs.
            question = question.split(" AS SELECT")[0] + " AS SELECT '' AS log_sha256, '' AS path, '' AS airframe WHERE false"
        results.append(database.execute(question).fetchall())
    return results


def main() -> int:
    document, fleet, study = sys.argv[1:]
    text = open(document, encoding="utf-8").read()
    blocks = re.findall(r"```sql\n(.*?)```", text, re.DOTALL)
    statements = [statement.strip() for block in blocks for statement in block.split(";") if statement.strip()]
    views, questions = statements[:2], statements[2:]
    assert len(questions) == 11, f"{len(questions)} questions"
    of_fleet, of_study = answers(views + questions, fleet)[2:], answers(views + questions, study)[2:]
    for number, (one, other) in enumerate(zip(of_fleet, of_study), 1):
        assert one or other, f"question {number} has no answer"
        print(f"question {number}: {len(one)} rows of the fleet, {len(other)} of the campaign")
    logs = {status: count for status, count, _, _ in of_fleet[0]}
    assert sum(logs.values()) == 14 and len(of_fleet[1]) == 2, (logs, of_fleet[1])
    assert {row[1] for row in of_fleet[1]} == {"no-manoeuvre", "not-a-flight"}, of_fleet[1]
    # The drift that the fleet was made with is the steepest one of Cm_alpha.
    steepest = next(row for row in of_fleet[5] if row[1] == "Cm_alpha")
    assert steepest[0] == "2" and steepest[2] < 0, steepest
    assert of_study[9], "the campaign is not scored"
    assert {row[0] for row in of_study[10]} == {"smpe", "ekf"}, of_study[10]
    # The table of columns in the document is the schema.
    table = text.split("### Estimates, schema 2")[1].split("### Logs")[0]
    named = [name.strip() for row in re.findall(r"^\| ([a-z0-9_, .]+) \|", table, re.MULTILINE) for name in row.split(",")]
    named = [name for name in named if name not in ("column", "...", "")]
    found = [row[0] for row in duckdb.sql(f"DESCRIBE FROM read_parquet('{fleet}/estimates/**/*.parquet', hive_partitioning = false)").fetchall()]
    # The budget stands in the document as its first column and three dots.
    shown = [name for name in found if not name.startswith("budget_") or name == "budget_airspeed_scale"]
    assert sorted(named) == sorted(shown), set(named) ^ set(shown)
    assert len(found) - len(shown) == 17, found
    print("the document is right: eleven questions and the columns of the schema")
    return 0


if __name__ == "__main__":
    sys.exit(main())
