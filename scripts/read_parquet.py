"""Reads Parquet files. The first argument is a list of columns, parted by commas, the others are files, which are read
one after the other; on stdout is one JSON object {COLUMN: [values of all rows]}. `phyvisgen diagnose` calls it; it knows
nothing of data sets."""
import json
import sys

import pyarrow.parquet

columns = sys.argv[1].split(",")
read = {column: [] for column in columns}
for path in sys.argv[2:]:
    table = pyarrow.parquet.read_table(path, columns=columns)
    missing = [column for column in columns if column not in table.column_names]
    if missing:
        sys.exit(f"{path} has no column {missing[0]}; it has: {', '.join(pyarrow.parquet.read_schema(path).names)}")
    for column in columns:
        read[column] += table[column].to_pylist()
json.dump(read, sys.stdout)
