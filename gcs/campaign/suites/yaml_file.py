"""Strict reading of YAML: parse, and point at the line of every error."""

from pathlib import Path

from gcs.config.text_file import read_text
from gcs.config.toml_file import ParsedFile
from gcs.config.validate import Key, UnusableFile, dotted
from gcs.extras import extra

with extra("suites", "tests in YAML"):
    import yaml

_DEPTH_MAX = 32
"""Levels of a file that are read; a test has five."""


def read_yaml(path: Path) -> ParsedFile:
    """Parse a YAML file of one mapping. Raises :class:`UnusableFile` with the line of an error."""
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
    return ParsedFile(path, data, lines)


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
