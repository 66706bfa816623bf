"""A JSON Schema accepts the files that are shipped and refuses what the loader refuses. Needs python3-jsonschema, python3-yaml."""
import json
import sys

import jsonschema
import yaml


def load(path):
    with open(path, encoding="utf-8") as f:
        return json.load(f)


def accepts(schema, text):
    return jsonschema.Draft7Validator(schema).is_valid(yaml.safe_load(text))


def check(schema, good, bad, good_texts=()):
    """good: paths; bad: texts. Tells what is not as it should be and ends the program."""
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    assert good, "no files to accept"
    failures = 0
    for path in good:
        with open(path, encoding="utf-8") as f:
            for error in validator.iter_errors(yaml.safe_load(f)):
                failures += 1
                print(f"{path}: {error.json_path}: {error.message}")
    for texts, wanted in ((good_texts, True), (bad, False)):
        for text in texts:
            if validator.is_valid(yaml.safe_load(text)) != wanted:
                failures += 1
                print(f"{'refused' if wanted else 'accepted'}: {text}")
    sys.exit(1 if failures else 0)
