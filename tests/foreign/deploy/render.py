"""Says manifests as JSON, one array of all documents: render.py FILE…"""

import json
import sys

import yaml

print(json.dumps([one for name in sys.argv[1:] for one in yaml.safe_load_all(open(name, encoding="utf-8")) if one]))
