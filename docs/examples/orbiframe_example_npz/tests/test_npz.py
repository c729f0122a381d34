"""The laws of readers and writers on the example."""

from orbiframe_example_npz.reader import read
from orbiframe_example_npz.writer import write

from orbiframe.testing import contract_tests

test_reader = contract_tests("reader", read, suffix=".npz", counterpart=write)
test_writer = contract_tests("writer", write, suffix=".npz", counterpart=read)
