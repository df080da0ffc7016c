/** The report page: header, scene, timeline, plots and events of one run, or of two that are compared. */

import { Clock } from './clock.js';
import { decode } from './data.js';
import { Scene } from './scene.js';

const [run, ghost] = await decode(document);
const page = /** @type {HTMLElement} */ (document.getElementById('page'));
page.replaceChildren();
const clock = new Clock(run.meta.begin, run.meta.end);
const stage = document.createElement('section');
stage.id = 'scene';
page.append(stage);
const scene = new Scene(stage, run, clock, ghost);
Object.assign(window, { report: { run, ghost, clock, scene } });
