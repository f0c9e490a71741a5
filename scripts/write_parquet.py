"""Writes Parquet files. Every line on stdin is a table as JSON: {"path": FILE, "metadata": {KEY: TEXT}, "columns":
[{"name": NAME, "type": TYPE, "values": [...]}]}, with the types float, double, int64, string and list<TYPE>. `phyvisgen pack`
calls it; it knows nothing of data sets."""
import json
import sys

import pyarrow
import pyarrow.parquet

PLAIN = {"float": pyarrow.float32(), "double": pyarrow.float64(), "int64": pyarrow.int64(), "string": pyarrow.string()}


def arrow_type(text):
    return pyarrow.list_(arrow_type(text[5:-1])) if text.startswith("list<") else PLAIN[text]


for line in sys.stdin:
    table = json.loads(line)
    fields = [pyarrow.field(column["name"], arrow_type(column["type"])) for column in table["columns"]]
    arrays = [pyarrow.array(column["values"], field.type) for column, field in zip(table["columns"], fields)]
    schema = pyarrow.schema(fields, metadata=table["metadata"] or None)
    pyarrow.parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=schema), table["path"])
