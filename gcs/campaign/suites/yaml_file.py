"""Strict reading of YAML: parse, and point at the line of every error."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gcs.config.text_file import read_text
from gcs.config.validate import Key, UnusableFile, dotted
from gcs.extras import extra

with extra("suites", "tests in YAML"):
    import yaml

_DEPTH_MAX = 32
"""Levels of a file that are read; a test has five."""


@dataclass(frozen=True)
class YamlFile:
    """A parsed YAML file of one mapping that knows the line of every key."""

    path: Path
    data: dict[str, Any]
    lines: dict[Key, int] = field(repr=False)
    """Line (from 1) of every key and of every element of a list."""

    def problem(self, key: Sequence[str | int], reason: str) -> str:
        """Return a message of one line: file, line, key, reason."""
        line = next((self.lines[tuple(key[:n])] for n in range(len(key), 0, -1) if tuple(key[:n]) in self.lines), 1)
        return f"{self.path}: line {line}: {dotted(key)}: {reason}"


def read_yaml(path: Path) -> YamlFile:
    """Parse a YAML file. Raises :class:`UnusableFile` with the line of an error."""
    text = read_text(path)
    loader = yaml.SafeLoader(text)
    try:
        _check_size(path, text)
        node = loader.get_single_node()
        lines: dict[Key, int] = {}
        problems = [] if node is None else _lines_of_keys(path, node, (), lines)
        if problems:
            raise UnusableFile(problems)
        data = None if node is None else loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise UnusableFile([f"{path}: line {mark.line + 1 if mark else 1}: not valid YAML: {error.problem}"]) from error
    except (yaml.YAMLError, ValueError) as error:
        raise UnusableFile([f"{path}: not valid YAML: {' '.join(str(error).split())}"]) from error
    if not isinstance(data, dict):
        raise UnusableFile([f"{path}: line 1: must be a mapping of keys"])
    return YamlFile(path, data, lines)


def _check_size(path: Path, text: str) -> None:
    """Raise :class:`UnusableFile` where a small file would take long to read."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        line = event.start_mark.line + 1
        # An alias stands for all that it names, over and over.
        if isinstance(event, yaml.AliasEvent):
            raise UnusableFile([f"{path}: line {line}: aliases (*) are not supported"])
        # The time to read grows with the square of the depth.
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > _DEPTH_MAX:
            raise UnusableFile([f"{path}: line {line}: nested more than {_DEPTH_MAX} levels deep"])


def _lines_of_keys(path: Path, node: yaml.Node, key: Key, lines: dict[Key, int]) -> list[str]:
    """Note the line of every key below ``node``; return what is wrong with them."""
    problems = []
    if isinstance(node, yaml.SequenceNode):
        for i, element in enumerate(node.value):
            lines[(*key, i)] = element.start_mark.line + 1
            problems += _lines_of_keys(path, element, (*key, i), lines)
    elif isinstance(node, yaml.MappingNode):
        for name, value in node.value:
            line = name.start_mark.line + 1
            if not isinstance(name, yaml.ScalarNode) or name.tag != "tag:yaml.org,2002:str":
                problems.append(f"{path}: line {line}: {dotted(key)}: a key must be text")
                continue
            below = (*key, name.value)
            if below in lines:
                problems.append(f"{path}: line {line}: {dotted(below)}: appears twice")
            lines[below] = line
            problems += _lines_of_keys(path, value, below, lines)
    return problems
