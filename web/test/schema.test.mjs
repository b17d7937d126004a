// node schema.test.mjs SCHEMA FOLDER: every results.json in the folder obeys the published schema, and the schema
// refuses what breaks it.
import Ajv2020 from "ajv/dist/2020.js";
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

const [schema_path, folder] = process.argv.slice(2);
const read = (path) => JSON.parse(readFileSync(path, "utf8"));
const validate = new Ajv2020({ allErrors: true, strict: true, allowUnionTypes: true }).compile(read(schema_path));

const samples = readdirSync(folder);
assert.ok(samples.length >= 6, `expected the sample results in ${folder}`);
for (const sample of samples) {
  const results = read(join(folder, sample, "results.json"));
  assert.ok(validate(results), `${sample}: ${JSON.stringify(validate.errors, null, 1)}`);
}

const breaks = {
  "a missing key": (r) => delete r.edv_ml,
  "an unknown key": (r) => (r.colour = "red"),
  "another schema": (r) => (r.schema = "dynasurf.ventricle/2"),
  "gates from 0": (r) => (r.gates[0].gate = 0),
  "a fraction above 1": (r) => (r.gates[0].edge.endo.stopped_fraction = 1.5),
  "an unknown verdict": (r) => (r.quality.verdict = "fine"),
  "a short hash": (r) => (r.provenance.inputs[0].sha256 = "abc"),
};
for (const [what, break_it] of Object.entries(breaks)) {
  const results = read(join(folder, "ok", "results.json"));
  break_it(results);
  assert.ok(!validate(results), `the schema accepts ${what}`);
}

console.log(`${samples.length} results obey the schema, ${Object.keys(breaks).length} broken ones are refused`);
