// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Record.h"

namespace explica::provenance {

std::string_view recordSchema() {
  return R"({
  "$schema": "http://json-schema.org/draft-07/schema#",
  "title": "Explica provenance record",
  "type": "object",
  "required": ["format", "format_version", "id", "software", "command", "options", "inputs",
               "outputs", "steps", "warnings", "termination", "exit_code", "results", "execution"],
  "additionalProperties": false,
  "definitions": {
    "hash": {"type": "string", "pattern": "^[0-9a-f]{64}$"},
    "size": {"type": "integer", "minimum": 0}
  },
  "properties": {
    "format": {"enum": ["explica-provenance"]},
    "format_version": {"enum": [1]},
    "id": {"type": "string", "pattern": "^[0-9a-f]{32}$"},
    "software": {
      "type": "object",
      "required": ["name", "version", "commit", "dirty"],
      "properties": {"name": {"enum": ["explica"]}, "version": {"type": "string"},
                     "commit": {"type": "string"}, "dirty": {"type": "boolean"}}
    },
    "command": {"type": "string", "minLength": 1},
    "options": {"type": "object"},
    "given": {"type": "array", "items": {"type": "string"}},
    "inputs": {"type": "array", "items": {
      "type": "object",
      "required": ["role", "name", "size", "sha256"],
      "properties": {"role": {"type": "string"}, "name": {"type": "string"},
                     "size": {"$ref": "#/definitions/size"},
                     "sha256": {"$ref": "#/definitions/hash"}, "parent": {"type": "string"}}
    }},
    "outputs": {"type": "array", "items": {
      "type": "object",
      "required": ["path"],
      "properties": {"path": {"type": "string"}, "varies": {"type": "boolean"},
                     "size": {"$ref": "#/definitions/size"},
                     "sha256": {"$ref": "#/definitions/hash"}}
    }},
    "steps": {"type": "array", "items": {
      "type": "object",
      "required": ["name", "termination"],
      "properties": {"name": {"type": "string"}, "iterations": {"type": "integer"},
                     "termination": {"type": "string"}}
    }},
    "warnings": {"type": "array", "items": {"type": "string"}},
    "termination": {"enum": ["not-run", "finished", "converged", "target-reached", "max-iterations",
                             "max-time", "interrupted", "stalled"]},
    "exit_code": {"enum": [0, 3]},
    "results": {"type": "object"},
    "meanings": {"type": "object", "additionalProperties": {"type": "object"}},
    "notes": {"type": "object"},
    "execution": {
      "type": "object",
      "required": ["started", "ended", "seconds", "steps", "peak_memory_bytes", "threads",
                   "libraries", "machine", "arguments", "argv", "inputs", "varying_outputs"],
      "properties": {
        "started": {"type": "string"}, "ended": {"type": "string"},
        "seconds": {"type": "number", "minimum": 0},
        "cpu_seconds": {"type": "number", "minimum": 0},
        "steps": {"type": "array", "items": {
          "type": "object", "required": ["name", "seconds"],
          "properties": {"name": {"type": "string"}, "seconds": {"type": "number"}}}},
        "peak_memory_bytes": {"$ref": "#/definitions/size"},
        "threads": {"type": "object", "required": ["count", "because"],
                    "properties": {"count": {"type": "integer"}, "because": {"type": "string"}}},
        "build": {"type": "object", "additionalProperties": {"type": "string"}},
        "libraries": {"type": "object"},
        "machine": {"type": "object", "properties": {"os": {"type": "string"}}},
        "private": {"type": "boolean"},
        "directory": {"type": "string"},
        "out": {"type": "string"},
        "arguments": {"type": "object"},
        "argv": {"type": "array", "items": {"type": "string"}},
        "inputs": {"type": "array", "items": {
          "type": "object", "required": ["role", "given"],
          "properties": {
            "role": {"type": "string"}, "given": {"type": "string"},
            "absolute": {"type": "string"},
            "parent_record": {
              "type": "object", "required": ["sha256"],
              "properties": {"sha256": {"$ref": "#/definitions/hash"},
                             "path": {"type": "string"}}}}}},
        "varying_outputs": {"type": "array", "items": {
          "type": "object", "required": ["path", "size", "sha256"],
          "properties": {"path": {"type": "string"}, "size": {"$ref": "#/definitions/size"},
                         "sha256": {"$ref": "#/definitions/hash"}}}}
      }
    }
  }
})";
}

}  // namespace explica::provenance
