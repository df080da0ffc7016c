/** The report page of one run, or of two that are compared, of a flight that is still going on, or of a campaign. */

import { campaignPage } from './campaign.js';
import { decode, decoded } from './data.js';
import { h } from './dom.js';
import { follow } from './live.js';
import { ReportPage } from './report.js';

const page = /** @type {HTMLElement} */ (document.getElementById('page'));

/** Show the runs that are in the page. */
async function show() {
  const [run, ghost] = await decode(document);
  Object.assign(window, { report: new ReportPage(page, run, ghost) });
}

/** Show a flight while it goes on. */
async function showLive() {
  page.replaceChildren(h('p.waiting', {}, 'Waiting for the first records of the flight …'));
  await follow(`ws://${window.location.host}/`, page, decoded);
}

/** Show a campaign. @param {Element} data */
async function showCampaign(data) {
  const campaign = JSON.parse(data.textContent ?? '');
  page.replaceChildren(...campaignPage(campaign));
  Object.assign(window, { report: { campaign } });
}

const campaign = document.querySelector('script.campaign');
const live = document.querySelector('script.live');
(campaign ? showCampaign(campaign) : live ? showLive() : show()).catch((error) => {
  page.replaceChildren(h('p.failed', {}, `The page cannot be shown: ${error.message}`));
  throw error;
});
