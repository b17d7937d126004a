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
if (!existsSync(join(work, 'node_modules', 'gltf-validator'))) {
  try {
    execFileSync('npm', ['ci', '--no-audit', '--no-fund'], {cwd: work, stdio: 'pipe'});
  } catch (error) {
    console.log('skipped: npm ci could not install gltf-validator (no network?): ' + String(error.stderr).split('\n')[0]);
    process.exit(77);
  }
}
const validator = createRequire(join(work, 'package.json'))('gltf-validator');

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
process.exit(bad > 0 ? 1 : 0);
