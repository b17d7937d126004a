// Lets laz-perf, another reader of LAZ, read what the tests' writer of LAZ writes: the same points, so that the program
// is tested against the format and not against the writer's idea of it.
// usage: node laz_reads.mjs TEST_IO WORK_FOLDER      exit code 77: skipped, laz-perf cannot be installed
import {execFileSync} from 'node:child_process';
import {copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [testProgram, work] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));

mkdirSync(work, {recursive: true});
for (const name of ['package.json', 'package-lock.json']) copyFileSync(join(here, name), join(work, name));
if (!existsSync(join(work, 'node_modules', 'laz-perf'))) {
  try {
    execFileSync('npm', ['ci', '--no-audit', '--no-fund'], {cwd: work, stdio: 'pipe'});
  } catch (error) {
    console.log('skipped: npm ci could not install laz-perf (no network?): ' + String(error.stderr).split('\n')[0]);
    process.exit(77);
  }
}
const {createLazPerf} = createRequire(join(work, 'package.json'))('laz-perf');
const perf = await createLazPerf();

const samples = join(work, 'laz');
rmSync(samples, {recursive: true, force: true});
mkdirSync(samples);
execFileSync(testProgram, ['--gtest_filter=Laz.WritesSamplesForAnotherReader'],
             {env: {...process.env, DYNASURF_LAZ_SAMPLES: samples}, stdio: 'pipe'});

/** The numbers of a point that the writer tells beside the file. */
function told(record, format) {
  const layered = format >= 6;
  const colour = {2: 20, 3: 28, 7: 30, 8: 30}[format];
  return [
    record.getInt32(0, true), record.getInt32(4, true), record.getInt32(8, true),
    record.getUint8(14) & (layered ? 15 : 7), record.getUint8(14) >> (layered ? 4 : 3) & (layered ? 15 : 7),
    record.getUint8(layered ? 16 : 15) & (layered ? 255 : 31),
    layered ? record.getUint8(15) & 4 : record.getUint8(15) >> 5 & 4,
    record.getUint16(layered ? 20 : 18, true),
    ...[0, 2, 4].map((n) => (colour === undefined ? 0 : record.getUint16(colour + n, true))),
  ];
}

let bad = 0;
const files = readdirSync(samples).filter((name) => name.endsWith('.laz'));
if (files.length < 7) throw new Error('expected at least 7 samples, found ' + files.length);
for (const name of files) {
  const format = Number(/\d/.exec(name)[0]);
  const bytes = readFileSync(join(samples, name));
  const plain = readFileSync(join(samples, name.replace('.laz', '.points')));
  const points = new Int32Array(plain.buffer.slice(plain.byteOffset, plain.byteOffset + plain.length));
  const place = perf._malloc(bytes.length), to = perf._malloc(256);
  perf.HEAPU8.set(bytes, place);
  const reader = new perf.LASZip();
  reader.open(place, bytes.length);
  let same = 0;
  const count = reader.getCount();
  for (let n = 0; n < count; ++n) {
    reader.getPoint(to);
    const record = new DataView(perf.HEAPU8.buffer, to, reader.getPointLength());
    const has_colour = [2, 3, 7, 8].includes(format);
    if (told(record, format).every((value, k) => value === points[11 * n + k] || (k >= 8 && !has_colour))) ++same;
  }
  console.log(`${name}: ${same} of ${points.length / 11} points are the same`);
  bad += same === points.length / 11 && same > 0 ? 0 : 1;
  reader.delete();
  perf._free(place);
  perf._free(to);
}
process.exit(bad > 0 ? 1 : 0);
