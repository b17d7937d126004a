// Lets the validator of the glTF makers judge what write_glb and write_lod_glb write: 0 errors and 0 warnings.
// usage: node gltf_validator.mjs TEST_IO WORK_FOLDER      exit code 77: skipped, the validator cannot be installed
import {execFileSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [testProgram, work] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));

// Packages go to the build folder; the sources stay clean.
mkdirSync(work, {recursive: true});
for (const name of ['package.json', 'package-lock.json']) copyFileSync(join(here, name), join(work, name));
if (!['gltf-validator', 'meshoptimizer'].every((name) => existsSync(join(work, 'node_modules', name)))) {
  try {
    execFileSync('npm', ['ci', '--no-audit', '--no-fund'], {cwd: work, stdio: 'pipe'});
  } catch (error) {
    console.log('skipped: npm ci could not install gltf-validator (no network?): ' + String(error.stderr).split('\n')[0]);
    process.exit(77);
  }
}
const judges = createRequire(join(work, 'package.json'));
const validator = judges('gltf-validator');
const {MeshoptDecoder} = judges('meshoptimizer');
await MeshoptDecoder.ready;

const samples = join(work, 'glb');
rmSync(samples, {recursive: true, force: true});
mkdirSync(samples);
execFileSync(testProgram, ['--gtest_filter=*Glb.WritesSamplesForTheValidator'],
             {env: {...process.env, DYNASURF_GLB_SAMPLES: samples}, stdio: 'pipe'});

const files = readdirSync(samples).filter(name => name.endsWith('.glb'));
if (files.length < 6) throw new Error('expected at least 6 samples, found ' + files.length);
let bad = 0;
for (const name of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(join(samples, name))), {uri: name});
  const {numErrors, numWarnings, numInfos, messages} = report.issues;
  console.log(`${name}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ` +
              `${report.info.totalVertexCount} vertices, ${report.info.animationCount} animations`);
  for (const m of messages) console.log(`  ${m.code} ${m.pointer ?? ''}: ${m.message}`);
  bad += numErrors + numWarnings;
}

// What a viewer unpacks of packed.glb is what plain_of_packed.glb holds, within half a step.
function open(name) {
  const bytes = readFileSync(join(samples, name));
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + length));
  return {json, binary: bytes.subarray(28 + length)};
}
function rows({json, binary}, accessor) {
  const {bufferView, componentType, count, type} = json.accessors[accessor];
  const view = json.bufferViews[bufferView];
  const packing = view.extensions?.EXT_meshopt_compression;
  let bytes = binary.subarray(view.byteOffset ?? 0, (view.byteOffset ?? 0) + view.byteLength);
  if (packing) {
    bytes = new Uint8Array(packing.count * packing.byteStride);
    MeshoptDecoder.decodeGltfBuffer(bytes, packing.count, packing.byteStride,
                                    binary.subarray(packing.byteOffset, packing.byteOffset + packing.byteLength),
                                    packing.mode, packing.filter);
  }
  const columns = {SCALAR: 1, VEC3: 3, VEC4: 4}[type];
  const [size, get] = {5120: [1, 'getInt8'], 5123: [2, 'getUint16'], 5125: [4, 'getUint32'], 5126: [4, 'getFloat32']}[componentType];
  const stride = packing?.byteStride ?? columns * size;
  const data = new DataView(bytes.buffer, bytes.byteOffset);
  return Array.from({length: count}, (_, n) => Array.from({length: columns}, (_, c) => data[get](n * stride + c * size, true)));
}
/** The triangles of a level as texts of their corners' places on the grid of `scale`, in their turn. */
function triangles(file, level, origin, scale) {
  const node = file.json.nodes[level];
  const {attributes, indices} = file.json.meshes[node.mesh].primitives[0];
  const step = node.scale ?? [1, 1, 1];
  const places = rows(file, attributes.POSITION).map((row) => row.map((v, c) => Math.round((v * step[c] + node.translation[c] - origin[c]) / scale)).join());
  const corners = rows(file, indices).map(([v]) => places[v]);
  const all = [];
  for (let n = 0; n < corners.length; n += 3) {
    const t = corners.slice(n, n + 3);
    const first = t.indexOf([...t].sort()[0]);
    all.push([...t.slice(first), ...t.slice(0, first)].join(';'));
  }
  return all.sort();
}
const [packed, plain] = [open('packed.glb'), open('plain_of_packed.glb')];
for (let level = 0; level < 2; ++level) {
  // On a grid of 128 steps a side few places are rounded to another step.
  const {translation, scale} = packed.json.nodes[level];
  const [a, b] = [packed, plain].map((file) => triangles(file, level, translation.map((v) => v - 11.3 * scale[0]), 512 * scale[0]));
  const same = a.filter((t, n) => t === b[n]).length;
  console.log(`packed.glb, level ${level + 1}: ${a.length} triangles, ${same} as they are unpacked elsewhere`);
  if (a.length !== b.length || same < 0.95 * a.length) ++bad;
}
process.exit(bad > 0 ? 1 : 0);
