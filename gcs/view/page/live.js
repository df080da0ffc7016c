/** A flight while it goes on: messages of gcs/view/live.py, each with what has come to be on record. */

import { ReportPage } from './report.js';

const REFRESH = 2000; // ms after which words, plots and scales follow, which take longer than what moves

/**
 * Show a flight until it is over, then its report.
 * @param {string} url of the web socket
 * @param {HTMLElement} element which the page fills
 * @param {(header: any, blob: string) => Promise<import('./data.js').Run>} decoded
 */
export function follow(url, element, decoded) {
  /** @type {ReportPage|null} */
  let report = null;
  let timer = 0;
  let isOver = false;

  /** @param {{header: any, blob: string, final: boolean}} message */
  async function take({ header, blob, final }) {
    const run = await decoded(header, blob);
    isOver = final;
    if (report && !final) {
      report.extend(run);
      timer ||= window.setTimeout(() => {
        timer = 0;
        report?.refresh();
      }, REFRESH);
      return;
    }
    window.clearTimeout(timer);
    timer = 0;
    report?.close();
    report = new ReportPage(element, run, undefined, !final);
    document.title = `${run.meta.mission}, seed ${run.meta.seed}: ${run.meta.outcome}`;
    Object.assign(window, { report });
  }

  return new Promise((resolve, reject) => {
    const socket = new WebSocket(url);
    let taken = Promise.resolve();
    socket.onmessage = ({ data }) => {
      // One after the other: unpacking takes its time.
      taken = taken.then(() => take(JSON.parse(data)));
      taken.catch(reject);
    };
    socket.onclose = () => taken.then(() => {
      if (report) {
        report.clock.live = false;
        report.clock.following = false;
        if (!isOver) {
          report.run.meta.outcome = 'connection lost';
          report.refresh();
        }
        resolve(undefined);
      } else reject(new Error('the connection ended before anything was flown'));
    });
  });
}
