// node cloud_schema.test.mjs SCHEMA FOLDER: every results.json of a cloud in the folder obeys the published schema, and
// the schema refuses what breaks it.
import Ajv2020 from "ajv/dist/2020.js";
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

const [schema_path, folder] = process.argv.slice(2);
const read = (path) => JSON.parse(readFileSync(path, "utf8"));
const schema = read(schema_path);
const validate = new Ajv2020({ allErrors: true, strict: true, allowUnionTypes: true }).compile(schema);

const samples = readdirSync(folder);
assert.ok(samples.length >= 3, `expected the sample results in ${folder}`);
for (const sample of samples) {
  const results = read(join(folder, sample, "results.json"));
  assert.ok(validate(results), `${sample}: ${JSON.stringify(validate.errors, null, 1)}`);
}

const breaks = {
  "a missing key": (r) => delete r.watertight,
  "a boundary that was not decided": (r) => (r.boundary = "auto"),
  "an unknown key": (r) => (r.colour = "red"),
  "another schema": (r) => (r.schema = "dynasurf.cloud/2"),
  "levels from 0": (r) => (r.levels[0].level = 0),
  "another name of a level": (r) => (r.levels[0].name = "mesh"),
  "an angle above 60 degrees": (r) => (r.levels[0].certificate.angles_deg.smallest = 61),
  "a negative distance": (r) => (r.levels[0].certificate.distances.cloud_to_mesh.mean = -1),
  "a certificate without its verdict": (r) => delete r.levels[0].certificate.watertight,
  "a short hash": (r) => (r.provenance.inputs[0].sha256 = "abc"),
};
for (const [what, break_it] of Object.entries(breaks)) {
  const results = read(join(folder, "ok", "results.json"));
  break_it(results);
  assert.ok(!validate(results), `the schema accepts ${what}`);
}

console.log(`${samples.length} results obey the schema, ${Object.keys(breaks).length} broken ones are refused`);
