/** The payload where the ground station believed it to be. */

import { payload } from './formation.js';
import { attitudeToScene, toScene } from './frames.js';

export class Estimate {
  /** @param {import('../data.js').Run} run @param {import('./palette.js').Palette} palette */
  constructor(run, palette) {
    this.position = run.meta.source === 'estimate' ? null : run.channel('estimate.payload.position');
    this.attitude = run.channel('estimate.payload.attitude');
    this.mesh = payload(run, palette.translucent('estimate', 0.2), palette.hairline('estimate'));
    this.mesh.visible = this.position !== null;
  }

  /** @param {number} time */
  update(time) {
    if (!this.position || !this.mesh.visible) return;
    toScene(this.position.at(time), this.mesh.position);
    if (this.attitude) attitudeToScene(this.attitude.at(time), this.mesh.quaternion);
  }
}
