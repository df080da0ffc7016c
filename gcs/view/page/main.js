/** The report page of one run, or of two that are compared, or of a campaign. */

import { campaignPage } from './campaign.js';
import { Clock } from './clock.js';
import { decode } from './data.js';
import { h } from './dom.js';
import { eventList } from './events.js';
import { cards, comparison, title } from './header.js';
import { Plots } from './plots.js';
import { Scene } from './scene.js';
import { timeline } from './timeline.js';

const page = /** @type {HTMLElement} */ (document.getElementById('page'));

/** Build the page around the runs that are in it. */
async function show() {
  const [run, ghost] = await decode(document);
  const clock = new Clock(run.meta.begin, run.meta.end);
  const stage = h('section', { id: 'scene', 'aria-label': 'scene' });
  const plots = h('section', { id: 'plots' });
  page.replaceChildren(
    h('header', {}, title(run)),
    h('div.top', {}, cards(run, clock), stage),
    timeline(run, clock),
    comparison(run, ghost) ?? '',
    eventList(run, clock),
    plots,
  );
  let scene = null;
  try {
    scene = new Scene(stage, run, clock, ghost);
  } catch (error) {
    console.warn(error);
    stage.replaceChildren(h('p.failed', {}, `The scene cannot be shown: ${error.message} (it needs WebGL).`));
    stage.classList.add('absent');
  }
  Object.assign(window, { report: { run, ghost, clock, scene, plots: new Plots(plots, run, clock, ghost) } });
  // The moment that says most: the least clearance, or else the beginning.
  clock.set(run.clearance?.time ?? run.meta.begin);
}

/** Build the page of a campaign. @param {Element} data */
async function showCampaign(data) {
  const campaign = JSON.parse(data.textContent ?? '');
  page.replaceChildren(...campaignPage(campaign));
  Object.assign(window, { report: { campaign } });
}

const campaign = document.querySelector('script.campaign');
(campaign ? showCampaign(campaign) : show()).catch((error) => {
  page.replaceChildren(h('p.failed', {}, `The page cannot be shown: ${error.message}`));
  throw error;
});
