/** The obstacles as they were, at their place at a time; the zones of the fence are in fence.js. */

import { EdgesGeometry, Group, LineSegments, Mesh } from 'three';
import { isZone } from './fence.js';
import { attitudeToScene, toScene } from './frames.js';
import { Polyline } from './polyline.js';
import { shapeGeometry } from './shapes.js';

export class Obstacles {
  /**
   * @param {import('../data.js').Run} run
   * @param {import('./palette.js').Palette} palette
   * @param {import('./labels.js').Labels} labels
   */
  constructor(run, palette, labels) {
    this.group = new Group();
    const surface = palette.solid('obstacle');
    const edge = palette.hairline('obstacle-edge', 0.7);
    const bodies = run.obstacles.filter((/** @type {any} */ obstacle) => !isZone(obstacle));
    this.obstacles = bodies.map((/** @type {any} */ obstacle) => {
      const geometry = shapeGeometry(obstacle);
      const mesh = new Mesh(geometry, surface);
      attitudeToScene(obstacle.quaternion, mesh.quaternion);
      if (obstacle.kind !== 'sphere') mesh.add(new LineSegments(new EdgesGeometry(geometry, 25), edge));
      if (obstacle.position) toScene(obstacle.position, mesh.position);
      geometry.computeBoundingSphere();
      const height = geometry.boundingSphere?.radius ?? 0;
      const top = obstacle.kind === 'pole' ? obstacle.size[2] / 2 : height;
      this.group.add(mesh);
      const channel = obstacle.channel ? run.channel(obstacle.channel) : null;
      const label = labels.add(obstacle.known ? obstacle.name : `${obstacle.name} (not on the map)`, 'obstacle');
      label.layer = () => this.group.visible;
      return { mesh, channel, label, top };
    });
    const path = palette.line('obstacle', 1.5, { transparent: true, opacity: 0.5 });
    for (const { channel } of this.obstacles) {
      if (!channel) continue;
      const line = new Polyline(path);
      const step = Math.max(1, Math.floor(channel.t.length / 1000));
      line.setPoints(Array.from({ length: Math.ceil(channel.t.length / step) }, (_, k) => channel.row(k * step)));
      this.group.add(line);
    }
  }

  /** @param {number} time */
  update(time) {
    for (const { mesh, channel, label, top } of this.obstacles) {
      if (channel) toScene(channel.at(time), mesh.position);
      label.position.copy(mesh.position);
      label.position.y += top;
    }
  }
}
