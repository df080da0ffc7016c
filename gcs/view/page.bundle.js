/* sources sha256 aeffc2866cb5c507909e7257fe37890ea4c64701bfb02990f9e78346294fb0af

three 0.170.0
The MIT License

Copyright © 2010-2024 three.js authors

Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in
all copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN
THE SOFTWARE.

uplot 1.6.31
The MIT License (MIT)

Copyright (c) 2022 Leon Sorokin

Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in
all copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN
THE SOFTWARE.*/
function O(i,t={},...e){let[n,...s]=i.split("."),r=document.createElement(n);s.length&&(r.className=s.join(" "));for(let[o,a]of Object.entries(t))o.startsWith("on")?r.addEventListener(o.slice(2),a):o.includes("-")?r.setAttribute(o,a):o==="style"?Object.assign(r.style,a):r[o]=a;return r.append(...e.filter(o=>o!=null&&o!==!1)),r}function bn(i){return getComputedStyle(document.documentElement).getPropertyValue(`--${i}`).trim()}function ue(i,t=2){return i==null||!Number.isFinite(i)?"not known":i.toFixed(t)}function ya(i,t){let e=O("button",{type:"button",title:i},t);return e.addEventListener("click",async()=>{try{await navigator.clipboard.writeText(i)}catch{let n=O("textarea",{value:i});document.body.append(n),n.select(),document.execCommand("copy"),n.remove()}e.textContent="copied",setTimeout(()=>{e.textContent=t},1500)}),e}var Ld=["collided","lost","failed","aborted","interrupted","completed"],Dd=[["clearance_min_m","Least clearance","m",2],["uav_separation_min_m","Distance between UAVs","m",2],["tilt_max_deg","Largest payload angle","°",1],["position_rmse_m","Position error, RMS","m",3],["delay_s","Delay","s",1],["detected_s","Time to the first alarm","s",2],["touchdown_mps","Touchdown speed","m/s",2]],Wc=24,Gs=i=>i.passed==="True",ii=(i,t)=>i[t]===void 0||i[t]===""?NaN:Number(i[t]);function Ud({name:i,flights:t}){let e=t.filter(Gs).length,n=e===t.length?"good":"bad",s=O("div.scroll.tall",{}),r=O("p.hint",{}),o=(c,h)=>{s.replaceChildren(b_(c));let f=c.length===t.length;r.replaceChildren(`${c.length} flights${h?`, ${h}`:""}, the worst first. `),f||r.append(O("button",{type:"button",onclick:()=>o(t,"")},"show all"))};o(t,"");let a=new Set(t.map(c=>c.level)),l=t.some(c=>c.fault)&&a.size>0;return[O("header",{},O("h1",{},i,O(`span.badge.${n}`,{},`${n==="good"?"✓":"✗"} ${e} of ${t.length} passed`))),O("section",{},O("h2",{},l?"Faults and severities":"Kinds"),l?v_(t,o):M_(t,o)),O("section",{},O("h2",{},"Distributions"),O("p.hint",{},O("span.swatch.passed",{})," passed  ",O("span.swatch.not",{})," not passed"),O("div.histograms",{},...Dd.map(c=>S_(t,...c)))),O("section",{id:"flights"},O("h2",{},"Flights"),r,s)]}function Nd(i,t,e,n){let s=i.filter(Gs).length,r=s===i.length?"good":s===0?"bad":"mixed",o=Fd(i)[0],a=o.outcome==="completed"?"":`worst: ${o.outcome}`;return O("td",{},O(`button.cell.${r}`,{type:"button",onclick:()=>{e(i,n),document.getElementById("flights").scrollIntoView()}},t?O("span",{},t):null,O("strong",{},`${s} of ${i.length}`),a?O("span",{},a):null))}function v_(i,t){let e=[...new Set(i.map(o=>o.fault))],n=Math.max(...i.map(o=>Number(o.level))),s=e.map(o=>{let a=i.filter(c=>c.fault===o),l=Array.from({length:n},(c,h)=>{let f=a.filter(u=>Number(u.level)===h+1);return f.length?Nd(f,f[0].severity,t,`${o}, ${f[0].severity}`):O("td",{})});return O("tr",{},O("th",{scope:"row"},o),...l)}),r=Array.from({length:n},(o,a)=>O("th",{},`severity ${a+1}`));return O("div.scroll.tall",{},O("table.matrix",{},O("thead",{},O("tr",{},O("th",{},"fault"),...r)),O("tbody",{},...s)))}function M_(i,t){let n=[...new Set(i.map(s=>[s.variant,s.kind].filter(Boolean).join(", ")))].map(s=>{let r=i.filter(l=>[l.variant,l.kind].filter(Boolean).join(", ")===s),o=r.filter(l=>ii(l,"contacts")>0).length,a=r.map(l=>ii(l,"clearance_min_m")).filter(Number.isFinite);return O("tr",{},O("th",{scope:"row"},s||"all"),Nd(r,"",t,s),O("td.number",{},`${o} with contacts`),O("td.number",{},a.length?`least clearance ${ue(Math.min(...a))} m`:""))});return O("div.scroll.tall",{},O("table.matrix",{},O("tbody",{},...n)))}function Fd(i){let t=e=>Number.isFinite(e)?e:1/0;return[...i].sort((e,n)=>Number(Gs(e))-Number(Gs(n))||Ld.indexOf(e.outcome)-Ld.indexOf(n.outcome)||t(ii(e,"clearance_min_m"))-t(ii(n,"clearance_min_m"))||t(-ii(e,"tilt_max_deg"))-t(-ii(n,"tilt_max_deg")))}function b_(i){let t=Dd.filter(([s])=>i.some(r=>Number.isFinite(ii(r,s)))).slice(0,5),e=Fd(i).map(s=>{let r=s.page?O("a",{href:s.page},s.name):s.name,o=[s.failures,s.reason].filter(Boolean).join(": ");return O("tr",{},O("td",{},r),O(`td.${Gs(s)?"held":"missed"}`,{},Gs(s)?"✓ passed":"✗ not passed"),O("td",{},s.outcome),...t.map(([a,,,l])=>O("td.number",{},Number.isFinite(ii(s,a))?ue(ii(s,a),l):"–")),O("td.text",{},o),O("td",{},s.replay?ya(s.replay,"copy command"):""))}),n=["flight","","outcome",...t.map(([,s,r])=>`${s} (${r})`),"why not","again"];return O("table.flights",{},O("thead",{},O("tr",{},...n.map(s=>O("th",{},s)))),O("tbody",{},...e))}function S_(i,t,e,n,s){let r=i.filter(m=>Number.isFinite(ii(m,t)));if(r.length<2)return null;let o=r.map(m=>ii(m,t)).sort((m,_)=>m-_),[a,l]=[o[0],o[o.length-1]],c=l-a||1,h=Array.from({length:Wc},()=>[0,0]);for(let m of r){let _=Math.min(Math.floor((ii(m,t)-a)/c*Wc),Wc-1);h[_][Gs(m)?1:0]+=1}let f=Math.max(...h.map(([m,_])=>m+_)),u=h.map(([m,_])=>O("span.bar",{title:`${_} passed, ${m} not`},O("span.bar-good",{style:{height:`${100*_/f}%`}}),O("span.bar-bad",{style:{height:`${100*m/f}%`}}))),d=o[Math.floor(o.length/2)];return O("figure.histogram",{},O("figcaption",{},`${e} (${n})`),O("div.bars",{},...u),O("div.range",{},O("span",{},ue(a,s)),O("span",{},`median ${ue(d,s)}`),O("span",{},ue(l,s))))}var Xc=class{constructor(t,e,n,s,r,o){this.name=t,this.t=e,this.columns=n,this.unit=s,this.shape=r,this.series=o,this.isQuaternion=n.join("")==="wxyz",this.last=0,this.grows=!1}append(t){let e=this.shape.length<3,n=e?t.columns.filter(l=>!this.columns.includes(l)):[],s=e?this.columns.length+n.length:Math.max(this.series.length,t.series.length);this.columns=[...this.columns,...n];let r=({t:l})=>new Float32Array(l.length).fill(NaN),o=Array.from({length:s},(l,c)=>this.series[c]??r(this)),a=o.map((l,c)=>t.series[e?t.columns.indexOf(this.columns[c]):c]??r(t));this.series=o.map((l,c)=>Od(l,a[c],this.grows&&c<this.series.length)),this.t=Od(this.t,t.t,this.grows),this.shape=[this.t.length,...this.shape.slice(1)],this.grows=!0}rowAt(t){let{t:e}=this,n=this.last<e.length&&e[this.last]<=t?this.last:0;for(let s=0;s<8&&n+1<e.length&&e[n+1]<=t;s+=1)n+=1;if(n+1<e.length&&e[n+1]<=t){let s=e.length;for(;s-n>1;){let r=n+s>>1;e[r]<=t?n=r:s=r}}return this.last=n,n}row(t){return this.series.map(e=>e[t])}path(t){let e=this.row(this.rowAt(t)),n=[];for(let s=0;s+2<e.length;s+=3)Number.isFinite(e[s])&&n.push(e.slice(s,s+3));return n}at(t){let e=this.rowAt(t),{t:n}=this;if(e+1>=n.length||t<=n[e])return this.row(e);let s=(t-n[e])/(n[e+1]-n[e]),r=this.row(e),o=this.row(e+1);return this.isQuaternion?w_(r,o,s):r.map((a,l)=>Number.isNaN(o[l])?a:a+s*(o[l]-a))}};function Od(i,t,e){let n=i.length+t.length,s=i.constructor,r=i;return(!e||i.byteOffset+n*s.BYTES_PER_ELEMENT>i.buffer.byteLength)&&(r=new s(2*n),r.set(i)),r=new s(r.buffer,r.byteOffset,n),r.set(t,i.length),r}function w_(i,t,e){let n=i[0]*t[0]+i[1]*t[1]+i[2]*t[2]+i[3]*t[3],s=n<0?-1:1;n=Math.min(Math.abs(n),1);let r=Math.acos(n),o=1-e,a=e;r>.001&&(o=Math.sin((1-e)*r)/Math.sin(r),a=Math.sin(e*r)/Math.sin(r));let l=i.map((h,f)=>o*h+s*a*t[f]),c=Math.hypot(...l);return l.map(h=>h/c)}function Bd([i,t,e,n]){let s=180/Math.PI,r=Math.max(-1,Math.min(1,2*(i*e-n*t)));return[Math.atan2(2*(i*t+e*n),1-2*(t*t+e*e))*s,Math.asin(r)*s,Math.atan2(2*(i*n+t*e),1-2*(e*e+n*n))*s]}var qc=class{constructor(t,e){this.header=t,this.meta=t.meta,this.events=t.events,this.obstacles=t.obstacles,this.tracks=t.tracks,this.standing=t.standing,this.clearance=t.clearance,this.blob=e,this.channels=new Map,this.times=new Map}has(t){return t in this.header.channels}names(t){return Object.keys(this.header.channels).filter(e=>e.startsWith(t))}channel(t){let e=this.header.channels[t];if(!e)return null;let n=this.channels.get(t);if(!n){let s=T_(this.blob,e.values);n=new Xc(t,this.time(e.t),e.columns,e.unit,e.values.shape,s),this.channels.set(t,n)}return n}extend(t){let e=!1;for(let n of Object.keys(t.header.channels)){let s=t.channel(n),r=this.channel(n);r?r.append(s):(this.header.channels[n]=t.header.channels[n],this.channels.set(n,s),e||=!n.startsWith("track."))}return Object.assign(this.meta,t.meta,{begin:this.meta.begin}),this.events=t.events,this.tracks=t.tracks,this.standing=t.standing,e&&(this.obstacles=t.obstacles),e}flown(t){return this.channel(`${this.meta.source}.payload.${t}`)}time(t){let e=this.times.get(t.offset);return e||(e=E_(this.blob,t),this.times.set(t.offset,e)),e}};function E_(i,t){let e=new Int32Array(i,t.offset,t.shape[0]),n=new Float64Array(e.length),s=t.first;for(let r=0;r<e.length;r+=1)s+=e[r],n[r]=s/1e6;return n}function T_(i,t){let e=t.shape[0],n=t.shape.slice(1).reduce((r,o)=>r*o,1),s=[];for(let r=0;r<n;r+=1){if(t.dtype==="float32"){s.push(new Float32Array(i,t.offset+4*e*r,e));continue}let o=new Uint16Array(i,t.offset+2*e*r,e),a=new Float32Array(e),l=0;for(let c=0;c<e;c+=1)l=l+o[c]&65535,a[c]=l===65535?NaN:t.first[r]+t.scale[r]*l;s.push(a)}return s}async function A_(i){let t=Uint8Array.from(atob(i.trim()),n=>n.charCodeAt(0)),e=new Blob([t]).stream().pipeThrough(new DecompressionStream("deflate"));return new Response(e).arrayBuffer()}async function zd(i){let t=[...i.querySelectorAll("script.run-header")],e=[...i.querySelectorAll("script.run-blob")];return Promise.all(t.map((n,s)=>{let r=e[s].textContent??"";return e[s].textContent="",Yc(JSON.parse(n.textContent??""),r)}))}async function Yc(i,t){return new qc(i,await A_(t))}var $c=[.1,.25,.5,1,2,4,8,16],va=class{constructor(t,e,n=!1){this.begin=t,this.end=e,this.live=n,this.following=n,this.time=t,this.speed=1,this.playing=!1,this.listeners=[],this.shown=0,this.way={from:t,to:e,since:performance.now(),lasts:1}}onChange(t,e){this.listeners.push(t),e?.addEventListener("abort",()=>{this.listeners=this.listeners.filter(n=>n!==t)}),t(this)}set(t){this.time=Math.min(Math.max(t,this.begin),this.end),this.followAtEnd(),this.following&&this.play(),this.changed()}followAtEnd(){this.following=this.live&&this.time>=this.end,Object.assign(this.way,{from:this.time,to:this.time})}extend(t){let e=performance.now();this.way={from:this.time,to:t,since:e,lasts:Math.max(e-this.way.since,1)},this.end=t,this.following&&this.play(),this.changed()}play(){this.playing||(this.time>=this.end&&!this.live&&(this.time=this.begin),this.playing=!0,this.shown=performance.now(),this.changed(),requestAnimationFrame(t=>this.frame(t)))}pause(){this.playing=!1,this.following=!1,this.changed()}toggle(){this.playing?this.pause():this.play()}changeSpeed(t){let e=$c.indexOf(this.speed)+t;this.speed=$c[Math.min(Math.max(e,0),$c.length-1)],this.changed()}frame(t){if(!this.playing)return;let e=Math.max(0,t-this.shown)/1e3;if(this.shown=t,this.following){let{from:n,to:s,since:r,lasts:o}=this.way;this.time=n+(s-n)*Math.min(Math.max(t-r,0)/o,1)}else this.time=Math.min(this.time+e*this.speed,this.end),this.followAtEnd(),this.playing=this.following||this.time<this.end;this.changed(),requestAnimationFrame(n=>this.frame(n))}changed(){for(let t of this.listeners)t(this)}};var C_={phase:"phase",mode:"mode",fault:"fault",alarm:"alarm",isolation:"isolated",contact:"contact",waypoint:"waypoint"};function kd(i,t,e){let n=i.events.map(o=>({row:O(`tr.event.${o.kind}`,{onclick:()=>t.set(o.start)},O("td.number",{},O("button.link",{type:"button"},`${o.start.toFixed(2)} s`)),O("td",{},O(`span.tag.${o.kind}`,{},C_[o.kind]??o.kind)),O("td",{},o.source),O("td.text",{},o.text+(o.end!==null&&o.kind==="fault"?`, to ${o.end.toFixed(2)} s`:""))),event:o})),s=-1;t.onChange(()=>{let o=-1;for(;o+1<n.length&&n[o+1].event.start<=t.time+1e-6;)o+=1;o!==s&&(n[s]?.row.classList.remove("current"),n[o]?.row.classList.add("current"),s=o)},e);let r=["time","kind","source","event"].map(o=>O("th",{},o));return O("section",{id:"events"},O("h2",{},"Events"),n.length?O("div.scroll",{},O("table",{},O("thead",{},O("tr",{},...r)),O("tbody",{},...n.map(({row:o})=>o)))):O("p",{},"None is on record."))}var nf="170",wi={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},Gi={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},R_=0,Vd=1,P_=2;var em=1,I_=2,ss=3,Ls=0,zn=1,yi=2,Rs=0,Gr=1,Hd=2,Gd=3,Wd=4,L_=5,Ks=100,D_=101,U_=102,N_=103,F_=104,O_=200,B_=201,z_=202,k_=203,Rh=204,Ph=205,V_=206,H_=207,G_=208,W_=209,X_=210,q_=211,Y_=212,$_=213,Z_=214,Ih=0,Lh=1,Dh=2,$r=3,Uh=4,Nh=5,Fh=6,Oh=7,sf=0,J_=1,K_=2,Ps=0,j_=1,Q_=2,tx=3,ex=4,nx=5,ix=6,sx=7;var nm=300,Zr=301,Jr=302,Bh=303,zh=304,zl=306,kh=1e3,Qs=1001,Vh=1002,bi=1003,rx=1004;var Ma=1005;var Oi=1006,Zc=1007;var tr=1008;var ls=1009,im=1010,sm=1011,Bo=1012,rf=1013,er=1014,rs=1015,Yo=1016,of=1017,af=1018,Kr=1020,rm=35902,om=1021,am=1022,Mi=1023,lm=1024,cm=1025,Wr=1026,jr=1027,hm=1028,lf=1029,um=1030,cf=1031;var hf=1033,ja=33776,Qa=33777,tl=33778,el=33779,Hh=35840,Gh=35841,Wh=35842,Xh=35843,qh=36196,Yh=37492,$h=37496,Zh=37808,Jh=37809,Kh=37810,jh=37811,Qh=37812,tu=37813,eu=37814,nu=37815,iu=37816,su=37817,ru=37818,ou=37819,au=37820,lu=37821,nl=36492,cu=36494,hu=36495,fm=36283,uu=36284,fu=36285,du=36286;var il=2300,pu=2301,Jc=2302,Xd=2400,qd=2401,Yd=2402;var ox=3200,ax=3201;var dm=0,lx=1,Cs="",ri="srgb",ro="srgb-linear",kl="linear",Le="srgb";var Ar=7680,pm=7681;var mm=517;var $d=519,cx=512,hx=513,ux=514,gm=515,fx=516,dx=517,px=518,mx=519,mu=35044;var Zd="300 es",os=2e3,sl=2001,cs=class{addEventListener(t,e){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[t]===void 0&&(n[t]=[]),n[t].indexOf(e)===-1&&n[t].push(e)}hasEventListener(t,e){if(this._listeners===void 0)return!1;let n=this._listeners;return n[t]!==void 0&&n[t].indexOf(e)!==-1}removeEventListener(t,e){if(this._listeners===void 0)return;let s=this._listeners[t];if(s!==void 0){let r=s.indexOf(e);r!==-1&&s.splice(r,1)}}dispatchEvent(t){if(this._listeners===void 0)return;let n=this._listeners[t.type];if(n!==void 0){t.target=this;let s=n.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,t);t.target=null}}},Sn=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],Jd=1234567,Xr=Math.PI/180,zo=180/Math.PI;function Bi(){let i=Math.random()*4294967295|0,t=Math.random()*4294967295|0,e=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(Sn[i&255]+Sn[i>>8&255]+Sn[i>>16&255]+Sn[i>>24&255]+"-"+Sn[t&255]+Sn[t>>8&255]+"-"+Sn[t>>16&15|64]+Sn[t>>24&255]+"-"+Sn[e&63|128]+Sn[e>>8&255]+"-"+Sn[e>>16&255]+Sn[e>>24&255]+Sn[n&255]+Sn[n>>8&255]+Sn[n>>16&255]+Sn[n>>24&255]).toLowerCase()}function nn(i,t,e){return Math.max(t,Math.min(e,i))}function uf(i,t){return(i%t+t)%t}function gx(i,t,e,n,s){return n+(i-t)*(s-n)/(e-t)}function _x(i,t,e){return i!==t?(e-i)/(t-i):0}function Uo(i,t,e){return(1-e)*i+e*t}function xx(i,t,e,n){return Uo(i,t,1-Math.exp(-e*n))}function yx(i,t=1){return t-Math.abs(uf(i,t*2)-t)}function vx(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*(3-2*i))}function Mx(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*i*(i*(i*6-15)+10))}function bx(i,t){return i+Math.floor(Math.random()*(t-i+1))}function Sx(i,t){return i+Math.random()*(t-i)}function wx(i){return i*(.5-Math.random())}function Ex(i){i!==void 0&&(Jd=i);let t=Jd+=1831565813;return t=Math.imul(t^t>>>15,t|1),t^=t+Math.imul(t^t>>>7,t|61),((t^t>>>14)>>>0)/4294967296}function Tx(i){return i*Xr}function Ax(i){return i*zo}function Cx(i){return(i&i-1)===0&&i!==0}function Rx(i){return Math.pow(2,Math.ceil(Math.log(i)/Math.LN2))}function Px(i){return Math.pow(2,Math.floor(Math.log(i)/Math.LN2))}function Ix(i,t,e,n,s){let r=Math.cos,o=Math.sin,a=r(e/2),l=o(e/2),c=r((t+n)/2),h=o((t+n)/2),f=r((t-n)/2),u=o((t-n)/2),d=r((n-t)/2),m=o((n-t)/2);switch(s){case"XYX":i.set(a*h,l*f,l*u,a*c);break;case"YZY":i.set(l*u,a*h,l*f,a*c);break;case"ZXZ":i.set(l*f,l*u,a*h,a*c);break;case"XZX":i.set(a*h,l*m,l*d,a*c);break;case"YXY":i.set(l*d,a*h,l*m,a*c);break;case"ZYZ":i.set(l*m,l*d,a*h,a*c);break;default:console.warn("THREE.MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function vi(i,t){switch(t.constructor){case Float32Array:return i;case Uint32Array:return i/4294967295;case Uint16Array:return i/65535;case Uint8Array:return i/255;case Int32Array:return Math.max(i/2147483647,-1);case Int16Array:return Math.max(i/32767,-1);case Int8Array:return Math.max(i/127,-1);default:throw new Error("Invalid component type.")}}function Re(i,t){switch(t.constructor){case Float32Array:return i;case Uint32Array:return Math.round(i*4294967295);case Uint16Array:return Math.round(i*65535);case Uint8Array:return Math.round(i*255);case Int32Array:return Math.round(i*2147483647);case Int16Array:return Math.round(i*32767);case Int8Array:return Math.round(i*127);default:throw new Error("Invalid component type.")}}var Vl={DEG2RAD:Xr,RAD2DEG:zo,generateUUID:Bi,clamp:nn,euclideanModulo:uf,mapLinear:gx,inverseLerp:_x,lerp:Uo,damp:xx,pingpong:yx,smoothstep:vx,smootherstep:Mx,randInt:bx,randFloat:Sx,randFloatSpread:wx,seededRandom:Ex,degToRad:Tx,radToDeg:Ax,isPowerOfTwo:Cx,ceilPowerOfTwo:Rx,floorPowerOfTwo:Px,setQuaternionFromProperEuler:Ix,normalize:Re,denormalize:vi},gt=class i{constructor(t=0,e=0){i.prototype.isVector2=!0,this.x=t,this.y=e}get width(){return this.x}set width(t){this.x=t}get height(){return this.y}set height(t){this.y=t}set(t,e){return this.x=t,this.y=e,this}setScalar(t){return this.x=t,this.y=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;default:throw new Error("index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;default:throw new Error("index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y)}copy(t){return this.x=t.x,this.y=t.y,this}add(t){return this.x+=t.x,this.y+=t.y,this}addScalar(t){return this.x+=t,this.y+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this}subScalar(t){return this.x-=t,this.y-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this}multiply(t){return this.x*=t.x,this.y*=t.y,this}multiplyScalar(t){return this.x*=t,this.y*=t,this}divide(t){return this.x/=t.x,this.y/=t.y,this}divideScalar(t){return this.multiplyScalar(1/t)}applyMatrix3(t){let e=this.x,n=this.y,s=t.elements;return this.x=s[0]*e+s[3]*n+s[6],this.y=s[1]*e+s[4]*n+s[7],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this}clamp(t,e){return this.x=Math.max(t.x,Math.min(e.x,this.x)),this.y=Math.max(t.y,Math.min(e.y,this.y)),this}clampScalar(t,e){return this.x=Math.max(t,Math.min(e,this.x)),this.y=Math.max(t,Math.min(e,this.y)),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(Math.max(t,Math.min(e,n)))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(t){return this.x*t.x+this.y*t.y}cross(t){return this.x*t.y-this.y*t.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(nn(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y;return e*e+n*n}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this}equals(t){return t.x===this.x&&t.y===this.y}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this}rotateAround(t,e){let n=Math.cos(e),s=Math.sin(e),r=this.x-t.x,o=this.y-t.y;return this.x=r*n-o*s+t.x,this.y=r*s+o*n+t.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},le=class i{constructor(t,e,n,s,r,o,a,l,c){i.prototype.isMatrix3=!0,this.elements=[1,0,0,0,1,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c)}set(t,e,n,s,r,o,a,l,c){let h=this.elements;return h[0]=t,h[1]=s,h[2]=a,h[3]=e,h[4]=r,h[5]=l,h[6]=n,h[7]=o,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],this}extractBasis(t,e,n){return t.setFromMatrix3Column(this,0),e.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(t){let e=t.elements;return this.set(e[0],e[4],e[8],e[1],e[5],e[9],e[2],e[6],e[10]),this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[3],l=n[6],c=n[1],h=n[4],f=n[7],u=n[2],d=n[5],m=n[8],_=s[0],g=s[3],p=s[6],S=s[1],v=s[4],y=s[7],U=s[2],R=s[5],P=s[8];return r[0]=o*_+a*S+l*U,r[3]=o*g+a*v+l*R,r[6]=o*p+a*y+l*P,r[1]=c*_+h*S+f*U,r[4]=c*g+h*v+f*R,r[7]=c*p+h*y+f*P,r[2]=u*_+d*S+m*U,r[5]=u*g+d*v+m*R,r[8]=u*p+d*y+m*P,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[3]*=t,e[6]*=t,e[1]*=t,e[4]*=t,e[7]*=t,e[2]*=t,e[5]*=t,e[8]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8];return e*o*h-e*a*c-n*r*h+n*a*l+s*r*c-s*o*l}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],f=h*o-a*c,u=a*l-h*r,d=c*r-o*l,m=e*f+n*u+s*d;if(m===0)return this.set(0,0,0,0,0,0,0,0,0);let _=1/m;return t[0]=f*_,t[1]=(s*c-h*n)*_,t[2]=(a*n-s*o)*_,t[3]=u*_,t[4]=(h*e-s*l)*_,t[5]=(s*r-a*e)*_,t[6]=d*_,t[7]=(n*l-c*e)*_,t[8]=(o*e-n*r)*_,this}transpose(){let t,e=this.elements;return t=e[1],e[1]=e[3],e[3]=t,t=e[2],e[2]=e[6],e[6]=t,t=e[5],e[5]=e[7],e[7]=t,this}getNormalMatrix(t){return this.setFromMatrix4(t).invert().transpose()}transposeIntoArray(t){let e=this.elements;return t[0]=e[0],t[1]=e[3],t[2]=e[6],t[3]=e[1],t[4]=e[4],t[5]=e[7],t[6]=e[2],t[7]=e[5],t[8]=e[8],this}setUvTransform(t,e,n,s,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*o+c*a)+o+t,-s*c,s*l,-s*(-c*o+l*a)+a+e,0,0,1),this}scale(t,e){return this.premultiply(Kc.makeScale(t,e)),this}rotate(t){return this.premultiply(Kc.makeRotation(-t)),this}translate(t,e){return this.premultiply(Kc.makeTranslation(t,e)),this}makeTranslation(t,e){return t.isVector2?this.set(1,0,t.x,0,1,t.y,0,0,1):this.set(1,0,t,0,1,e,0,0,1),this}makeRotation(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,n,e,0,0,0,1),this}makeScale(t,e){return this.set(t,0,0,0,e,0,0,0,1),this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<9;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<9;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t}clone(){return new this.constructor().fromArray(this.elements)}},Kc=new le;function _m(i){for(let t=i.length-1;t>=0;--t)if(i[t]>=65535)return!0;return!1}function rl(i){return document.createElementNS("http://www.w3.org/1999/xhtml",i)}function Lx(){let i=rl("canvas");return i.style.display="block",i}var Kd={};function Lo(i){i in Kd||(Kd[i]=!0,console.warn(i))}function Dx(i,t,e){return new Promise(function(n,s){function r(){switch(i.clientWaitSync(t,i.SYNC_FLUSH_COMMANDS_BIT,0)){case i.WAIT_FAILED:s();break;case i.TIMEOUT_EXPIRED:setTimeout(r,e);break;default:n()}}setTimeout(r,e)})}function Ux(i){let t=i.elements;t[2]=.5*t[2]+.5*t[3],t[6]=.5*t[6]+.5*t[7],t[10]=.5*t[10]+.5*t[11],t[14]=.5*t[14]+.5*t[15]}function Nx(i){let t=i.elements;t[11]===-1?(t[10]=-t[10]-1,t[14]=-t[14]):(t[10]=-t[10],t[14]=-t[14]+1)}var be={enabled:!0,workingColorSpace:ro,spaces:{},convert:function(i,t,e){return this.enabled===!1||t===e||!t||!e||(this.spaces[t].transfer===Le&&(i.r=as(i.r),i.g=as(i.g),i.b=as(i.b)),this.spaces[t].primaries!==this.spaces[e].primaries&&(i.applyMatrix3(this.spaces[t].toXYZ),i.applyMatrix3(this.spaces[e].fromXYZ)),this.spaces[e].transfer===Le&&(i.r=qr(i.r),i.g=qr(i.g),i.b=qr(i.b))),i},fromWorkingColorSpace:function(i,t){return this.convert(i,this.workingColorSpace,t)},toWorkingColorSpace:function(i,t){return this.convert(i,t,this.workingColorSpace)},getPrimaries:function(i){return this.spaces[i].primaries},getTransfer:function(i){return i===Cs?kl:this.spaces[i].transfer},getLuminanceCoefficients:function(i,t=this.workingColorSpace){return i.fromArray(this.spaces[t].luminanceCoefficients)},define:function(i){Object.assign(this.spaces,i)},_getMatrix:function(i,t,e){return i.copy(this.spaces[t].toXYZ).multiply(this.spaces[e].fromXYZ)},_getDrawingBufferColorSpace:function(i){return this.spaces[i].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(i=this.workingColorSpace){return this.spaces[i].workingColorSpaceConfig.unpackColorSpace}};function as(i){return i<.04045?i*.0773993808:Math.pow(i*.9478672986+.0521327014,2.4)}function qr(i){return i<.0031308?i*12.92:1.055*Math.pow(i,.41666)-.055}var jd=[.64,.33,.3,.6,.15,.06],Qd=[.2126,.7152,.0722],tp=[.3127,.329],ep=new le().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),np=new le().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);be.define({[ro]:{primaries:jd,whitePoint:tp,transfer:kl,toXYZ:ep,fromXYZ:np,luminanceCoefficients:Qd,workingColorSpaceConfig:{unpackColorSpace:ri},outputColorSpaceConfig:{drawingBufferColorSpace:ri}},[ri]:{primaries:jd,whitePoint:tp,transfer:Le,toXYZ:ep,fromXYZ:np,luminanceCoefficients:Qd,outputColorSpaceConfig:{drawingBufferColorSpace:ri}}});var Cr,gu=class{static getDataURL(t){if(/^data:/i.test(t.src)||typeof HTMLCanvasElement>"u")return t.src;let e;if(t instanceof HTMLCanvasElement)e=t;else{Cr===void 0&&(Cr=rl("canvas")),Cr.width=t.width,Cr.height=t.height;let n=Cr.getContext("2d");t instanceof ImageData?n.putImageData(t,0,0):n.drawImage(t,0,0,t.width,t.height),e=Cr}return e.width>2048||e.height>2048?(console.warn("THREE.ImageUtils.getDataURL: Image converted to jpg for performance reasons",t),e.toDataURL("image/jpeg",.6)):e.toDataURL("image/png")}static sRGBToLinear(t){if(typeof HTMLImageElement<"u"&&t instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&t instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&t instanceof ImageBitmap){let e=rl("canvas");e.width=t.width,e.height=t.height;let n=e.getContext("2d");n.drawImage(t,0,0,t.width,t.height);let s=n.getImageData(0,0,t.width,t.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=as(r[o]/255)*255;return n.putImageData(s,0,0),e}else if(t.data){let e=t.data.slice(0);for(let n=0;n<e.length;n++)e instanceof Uint8Array||e instanceof Uint8ClampedArray?e[n]=Math.floor(as(e[n]/255)*255):e[n]=as(e[n]);return{data:e,width:t.width,height:t.height}}else return console.warn("THREE.ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),t}},Fx=0,ol=class{constructor(t=null){this.isSource=!0,Object.defineProperty(this,"id",{value:Fx++}),this.uuid=Bi(),this.data=t,this.dataReady=!0,this.version=0}set needsUpdate(t){t===!0&&this.version++}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.images[this.uuid]!==void 0)return t.images[this.uuid];let n={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(jc(s[o].image)):r.push(jc(s[o]))}else r=jc(s);n.url=r}return e||(t.images[this.uuid]=n),n}};function jc(i){return typeof HTMLImageElement<"u"&&i instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&i instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&i instanceof ImageBitmap?gu.getDataURL(i):i.data?{data:Array.from(i.data),width:i.width,height:i.height,type:i.data.constructor.name}:(console.warn("THREE.Texture: Unable to serialize Texture."),{})}var Ox=0,oi=class i extends cs{constructor(t=i.DEFAULT_IMAGE,e=i.DEFAULT_MAPPING,n=Qs,s=Qs,r=Oi,o=tr,a=Mi,l=ls,c=i.DEFAULT_ANISOTROPY,h=Cs){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:Ox++}),this.uuid=Bi(),this.name="",this.source=new ol(t),this.mipmaps=[],this.mapping=e,this.channel=0,this.wrapS=n,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new gt(0,0),this.repeat=new gt(1,1),this.center=new gt(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new le,this.generateMipmaps=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.version=0,this.onUpdate=null,this.isRenderTargetTexture=!1,this.pmremVersion=0}get image(){return this.source.data}set image(t=null){this.source.data=t}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}clone(){return new this.constructor().copy(this)}copy(t){return this.name=t.name,this.source=t.source,this.mipmaps=t.mipmaps.slice(0),this.mapping=t.mapping,this.channel=t.channel,this.wrapS=t.wrapS,this.wrapT=t.wrapT,this.magFilter=t.magFilter,this.minFilter=t.minFilter,this.anisotropy=t.anisotropy,this.format=t.format,this.internalFormat=t.internalFormat,this.type=t.type,this.offset.copy(t.offset),this.repeat.copy(t.repeat),this.center.copy(t.center),this.rotation=t.rotation,this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrix.copy(t.matrix),this.generateMipmaps=t.generateMipmaps,this.premultiplyAlpha=t.premultiplyAlpha,this.flipY=t.flipY,this.unpackAlignment=t.unpackAlignment,this.colorSpace=t.colorSpace,this.userData=JSON.parse(JSON.stringify(t.userData)),this.needsUpdate=!0,this}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.textures[this.uuid]!==void 0)return t.textures[this.uuid];let n={metadata:{version:4.6,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(t).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),e||(t.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(t){if(this.mapping!==nm)return t;if(t.applyMatrix3(this.matrix),t.x<0||t.x>1)switch(this.wrapS){case kh:t.x=t.x-Math.floor(t.x);break;case Qs:t.x=t.x<0?0:1;break;case Vh:Math.abs(Math.floor(t.x)%2)===1?t.x=Math.ceil(t.x)-t.x:t.x=t.x-Math.floor(t.x);break}if(t.y<0||t.y>1)switch(this.wrapT){case kh:t.y=t.y-Math.floor(t.y);break;case Qs:t.y=t.y<0?0:1;break;case Vh:Math.abs(Math.floor(t.y)%2)===1?t.y=Math.ceil(t.y)-t.y:t.y=t.y-Math.floor(t.y);break}return this.flipY&&(t.y=1-t.y),t}set needsUpdate(t){t===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(t){t===!0&&this.pmremVersion++}};oi.DEFAULT_IMAGE=null;oi.DEFAULT_MAPPING=nm;oi.DEFAULT_ANISOTROPY=1;var De=class i{constructor(t=0,e=0,n=0,s=1){i.prototype.isVector4=!0,this.x=t,this.y=e,this.z=n,this.w=s}get width(){return this.z}set width(t){this.z=t}get height(){return this.w}set height(t){this.w=t}set(t,e,n,s){return this.x=t,this.y=e,this.z=n,this.w=s,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this.w=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setW(t){return this.w=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;case 3:this.w=e;break;default:throw new Error("index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this.w=t.w!==void 0?t.w:1,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this.w+=t.w,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this.w+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this.w=t.w+e.w,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this.w+=t.w*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this.w-=t.w,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this.w-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this.w=t.w-e.w,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this.w*=t.w,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this.w*=t,this}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=this.w,o=t.elements;return this.x=o[0]*e+o[4]*n+o[8]*s+o[12]*r,this.y=o[1]*e+o[5]*n+o[9]*s+o[13]*r,this.z=o[2]*e+o[6]*n+o[10]*s+o[14]*r,this.w=o[3]*e+o[7]*n+o[11]*s+o[15]*r,this}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this.w/=t.w,this}divideScalar(t){return this.multiplyScalar(1/t)}setAxisAngleFromQuaternion(t){this.w=2*Math.acos(t.w);let e=Math.sqrt(1-t.w*t.w);return e<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=t.x/e,this.y=t.y/e,this.z=t.z/e),this}setAxisAngleFromRotationMatrix(t){let e,n,s,r,l=t.elements,c=l[0],h=l[4],f=l[8],u=l[1],d=l[5],m=l[9],_=l[2],g=l[6],p=l[10];if(Math.abs(h-u)<.01&&Math.abs(f-_)<.01&&Math.abs(m-g)<.01){if(Math.abs(h+u)<.1&&Math.abs(f+_)<.1&&Math.abs(m+g)<.1&&Math.abs(c+d+p-3)<.1)return this.set(1,0,0,0),this;e=Math.PI;let v=(c+1)/2,y=(d+1)/2,U=(p+1)/2,R=(h+u)/4,P=(f+_)/4,F=(m+g)/4;return v>y&&v>U?v<.01?(n=0,s=.707106781,r=.707106781):(n=Math.sqrt(v),s=R/n,r=P/n):y>U?y<.01?(n=.707106781,s=0,r=.707106781):(s=Math.sqrt(y),n=R/s,r=F/s):U<.01?(n=.707106781,s=.707106781,r=0):(r=Math.sqrt(U),n=P/r,s=F/r),this.set(n,s,r,e),this}let S=Math.sqrt((g-m)*(g-m)+(f-_)*(f-_)+(u-h)*(u-h));return Math.abs(S)<.001&&(S=1),this.x=(g-m)/S,this.y=(f-_)/S,this.z=(u-h)/S,this.w=Math.acos((c+d+p-1)/2),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this.w=e[15],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this.w=Math.min(this.w,t.w),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this.w=Math.max(this.w,t.w),this}clamp(t,e){return this.x=Math.max(t.x,Math.min(e.x,this.x)),this.y=Math.max(t.y,Math.min(e.y,this.y)),this.z=Math.max(t.z,Math.min(e.z,this.z)),this.w=Math.max(t.w,Math.min(e.w,this.w)),this}clampScalar(t,e){return this.x=Math.max(t,Math.min(e,this.x)),this.y=Math.max(t,Math.min(e,this.y)),this.z=Math.max(t,Math.min(e,this.z)),this.w=Math.max(t,Math.min(e,this.w)),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(Math.max(t,Math.min(e,n)))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z+this.w*t.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this.w+=(t.w-this.w)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this.w=t.w+(e.w-t.w)*n,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z&&t.w===this.w}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this.w=t[e+3],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t[e+3]=this.w,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this.w=t.getW(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},_u=class extends cs{constructor(t=1,e=1,n={}){super(),this.isRenderTarget=!0,this.width=t,this.height=e,this.depth=1,this.scissor=new De(0,0,t,e),this.scissorTest=!1,this.viewport=new De(0,0,t,e);let s={width:t,height:e,depth:1};n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:Oi,depthBuffer:!0,stencilBuffer:!1,resolveDepthBuffer:!0,resolveStencilBuffer:!0,depthTexture:null,samples:0,count:1},n);let r=new oi(s,n.mapping,n.wrapS,n.wrapT,n.magFilter,n.minFilter,n.format,n.type,n.anisotropy,n.colorSpace);r.flipY=!1,r.generateMipmaps=n.generateMipmaps,r.internalFormat=n.internalFormat,this.textures=[];let o=n.count;for(let a=0;a<o;a++)this.textures[a]=r.clone(),this.textures[a].isRenderTargetTexture=!0;this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.depthTexture=n.depthTexture,this.samples=n.samples}get texture(){return this.textures[0]}set texture(t){this.textures[0]=t}setSize(t,e,n=1){if(this.width!==t||this.height!==e||this.depth!==n){this.width=t,this.height=e,this.depth=n;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=t,this.textures[s].image.height=e,this.textures[s].image.depth=n;this.dispose()}this.viewport.set(0,0,t,e),this.scissor.set(0,0,t,e)}clone(){return new this.constructor().copy(this)}copy(t){this.width=t.width,this.height=t.height,this.depth=t.depth,this.scissor.copy(t.scissor),this.scissorTest=t.scissorTest,this.viewport.copy(t.viewport),this.textures.length=0;for(let n=0,s=t.textures.length;n<s;n++)this.textures[n]=t.textures[n].clone(),this.textures[n].isRenderTargetTexture=!0;let e=Object.assign({},t.texture.image);return this.texture.source=new ol(e),this.depthBuffer=t.depthBuffer,this.stencilBuffer=t.stencilBuffer,this.resolveDepthBuffer=t.resolveDepthBuffer,this.resolveStencilBuffer=t.resolveStencilBuffer,t.depthTexture!==null&&(this.depthTexture=t.depthTexture.clone()),this.samples=t.samples,this}dispose(){this.dispatchEvent({type:"dispose"})}},hs=class extends _u{constructor(t=1,e=1,n={}){super(t,e,n),this.isWebGLRenderTarget=!0}},al=class extends oi{constructor(t=null,e=1,n=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=bi,this.minFilter=bi,this.wrapR=Qs,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}addLayerUpdate(t){this.layerUpdates.add(t)}clearLayerUpdates(){this.layerUpdates.clear()}};var xu=class extends oi{constructor(t=null,e=1,n=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=bi,this.minFilter=bi,this.wrapR=Qs,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var kn=class{constructor(t=0,e=0,n=0,s=1){this.isQuaternion=!0,this._x=t,this._y=e,this._z=n,this._w=s}static slerpFlat(t,e,n,s,r,o,a){let l=n[s+0],c=n[s+1],h=n[s+2],f=n[s+3],u=r[o+0],d=r[o+1],m=r[o+2],_=r[o+3];if(a===0){t[e+0]=l,t[e+1]=c,t[e+2]=h,t[e+3]=f;return}if(a===1){t[e+0]=u,t[e+1]=d,t[e+2]=m,t[e+3]=_;return}if(f!==_||l!==u||c!==d||h!==m){let g=1-a,p=l*u+c*d+h*m+f*_,S=p>=0?1:-1,v=1-p*p;if(v>Number.EPSILON){let U=Math.sqrt(v),R=Math.atan2(U,p*S);g=Math.sin(g*R)/U,a=Math.sin(a*R)/U}let y=a*S;if(l=l*g+u*y,c=c*g+d*y,h=h*g+m*y,f=f*g+_*y,g===1-a){let U=1/Math.sqrt(l*l+c*c+h*h+f*f);l*=U,c*=U,h*=U,f*=U}}t[e]=l,t[e+1]=c,t[e+2]=h,t[e+3]=f}static multiplyQuaternionsFlat(t,e,n,s,r,o){let a=n[s],l=n[s+1],c=n[s+2],h=n[s+3],f=r[o],u=r[o+1],d=r[o+2],m=r[o+3];return t[e]=a*m+h*f+l*d-c*u,t[e+1]=l*m+h*u+c*f-a*d,t[e+2]=c*m+h*d+a*u-l*f,t[e+3]=h*m-a*f-l*u-c*d,t}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get w(){return this._w}set w(t){this._w=t,this._onChangeCallback()}set(t,e,n,s){return this._x=t,this._y=e,this._z=n,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(t){return this._x=t.x,this._y=t.y,this._z=t.z,this._w=t.w,this._onChangeCallback(),this}setFromEuler(t,e=!0){let n=t._x,s=t._y,r=t._z,o=t._order,a=Math.cos,l=Math.sin,c=a(n/2),h=a(s/2),f=a(r/2),u=l(n/2),d=l(s/2),m=l(r/2);switch(o){case"XYZ":this._x=u*h*f+c*d*m,this._y=c*d*f-u*h*m,this._z=c*h*m+u*d*f,this._w=c*h*f-u*d*m;break;case"YXZ":this._x=u*h*f+c*d*m,this._y=c*d*f-u*h*m,this._z=c*h*m-u*d*f,this._w=c*h*f+u*d*m;break;case"ZXY":this._x=u*h*f-c*d*m,this._y=c*d*f+u*h*m,this._z=c*h*m+u*d*f,this._w=c*h*f-u*d*m;break;case"ZYX":this._x=u*h*f-c*d*m,this._y=c*d*f+u*h*m,this._z=c*h*m-u*d*f,this._w=c*h*f+u*d*m;break;case"YZX":this._x=u*h*f+c*d*m,this._y=c*d*f+u*h*m,this._z=c*h*m-u*d*f,this._w=c*h*f-u*d*m;break;case"XZY":this._x=u*h*f-c*d*m,this._y=c*d*f-u*h*m,this._z=c*h*m+u*d*f,this._w=c*h*f+u*d*m;break;default:console.warn("THREE.Quaternion: .setFromEuler() encountered an unknown order: "+o)}return e===!0&&this._onChangeCallback(),this}setFromAxisAngle(t,e){let n=e/2,s=Math.sin(n);return this._x=t.x*s,this._y=t.y*s,this._z=t.z*s,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(t){let e=t.elements,n=e[0],s=e[4],r=e[8],o=e[1],a=e[5],l=e[9],c=e[2],h=e[6],f=e[10],u=n+a+f;if(u>0){let d=.5/Math.sqrt(u+1);this._w=.25/d,this._x=(h-l)*d,this._y=(r-c)*d,this._z=(o-s)*d}else if(n>a&&n>f){let d=2*Math.sqrt(1+n-a-f);this._w=(h-l)/d,this._x=.25*d,this._y=(s+o)/d,this._z=(r+c)/d}else if(a>f){let d=2*Math.sqrt(1+a-n-f);this._w=(r-c)/d,this._x=(s+o)/d,this._y=.25*d,this._z=(l+h)/d}else{let d=2*Math.sqrt(1+f-n-a);this._w=(o-s)/d,this._x=(r+c)/d,this._y=(l+h)/d,this._z=.25*d}return this._onChangeCallback(),this}setFromUnitVectors(t,e){let n=t.dot(e)+1;return n<Number.EPSILON?(n=0,Math.abs(t.x)>Math.abs(t.z)?(this._x=-t.y,this._y=t.x,this._z=0,this._w=n):(this._x=0,this._y=-t.z,this._z=t.y,this._w=n)):(this._x=t.y*e.z-t.z*e.y,this._y=t.z*e.x-t.x*e.z,this._z=t.x*e.y-t.y*e.x,this._w=n),this.normalize()}angleTo(t){return 2*Math.acos(Math.abs(nn(this.dot(t),-1,1)))}rotateTowards(t,e){let n=this.angleTo(t);if(n===0)return this;let s=Math.min(1,e/n);return this.slerp(t,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(t){return this._x*t._x+this._y*t._y+this._z*t._z+this._w*t._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let t=this.length();return t===0?(this._x=0,this._y=0,this._z=0,this._w=1):(t=1/t,this._x=this._x*t,this._y=this._y*t,this._z=this._z*t,this._w=this._w*t),this._onChangeCallback(),this}multiply(t){return this.multiplyQuaternions(this,t)}premultiply(t){return this.multiplyQuaternions(t,this)}multiplyQuaternions(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=e._x,l=e._y,c=e._z,h=e._w;return this._x=n*h+o*a+s*c-r*l,this._y=s*h+o*l+r*a-n*c,this._z=r*h+o*c+n*l-s*a,this._w=o*h-n*a-s*l-r*c,this._onChangeCallback(),this}slerp(t,e){if(e===0)return this;if(e===1)return this.copy(t);let n=this._x,s=this._y,r=this._z,o=this._w,a=o*t._w+n*t._x+s*t._y+r*t._z;if(a<0?(this._w=-t._w,this._x=-t._x,this._y=-t._y,this._z=-t._z,a=-a):this.copy(t),a>=1)return this._w=o,this._x=n,this._y=s,this._z=r,this;let l=1-a*a;if(l<=Number.EPSILON){let d=1-e;return this._w=d*o+e*this._w,this._x=d*n+e*this._x,this._y=d*s+e*this._y,this._z=d*r+e*this._z,this.normalize(),this}let c=Math.sqrt(l),h=Math.atan2(c,a),f=Math.sin((1-e)*h)/c,u=Math.sin(e*h)/c;return this._w=o*f+this._w*u,this._x=n*f+this._x*u,this._y=s*f+this._y*u,this._z=r*f+this._z*u,this._onChangeCallback(),this}slerpQuaternions(t,e,n){return this.copy(t).slerp(e,n)}random(){let t=2*Math.PI*Math.random(),e=2*Math.PI*Math.random(),n=Math.random(),s=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(s*Math.sin(t),s*Math.cos(t),r*Math.sin(e),r*Math.cos(e))}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._w===this._w}fromArray(t,e=0){return this._x=t[e],this._y=t[e+1],this._z=t[e+2],this._w=t[e+3],this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._w,t}fromBufferAttribute(t,e){return this._x=t.getX(e),this._y=t.getY(e),this._z=t.getZ(e),this._w=t.getW(e),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},D=class i{constructor(t=0,e=0,n=0){i.prototype.isVector3=!0,this.x=t,this.y=e,this.z=n}set(t,e,n){return n===void 0&&(n=this.z),this.x=t,this.y=e,this.z=n,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;default:throw new Error("index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this}multiplyVectors(t,e){return this.x=t.x*e.x,this.y=t.y*e.y,this.z=t.z*e.z,this}applyEuler(t){return this.applyQuaternion(ip.setFromEuler(t))}applyAxisAngle(t,e){return this.applyQuaternion(ip.setFromAxisAngle(t,e))}applyMatrix3(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[3]*n+r[6]*s,this.y=r[1]*e+r[4]*n+r[7]*s,this.z=r[2]*e+r[5]*n+r[8]*s,this}applyNormalMatrix(t){return this.applyMatrix3(t).normalize()}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=t.elements,o=1/(r[3]*e+r[7]*n+r[11]*s+r[15]);return this.x=(r[0]*e+r[4]*n+r[8]*s+r[12])*o,this.y=(r[1]*e+r[5]*n+r[9]*s+r[13])*o,this.z=(r[2]*e+r[6]*n+r[10]*s+r[14])*o,this}applyQuaternion(t){let e=this.x,n=this.y,s=this.z,r=t.x,o=t.y,a=t.z,l=t.w,c=2*(o*s-a*n),h=2*(a*e-r*s),f=2*(r*n-o*e);return this.x=e+l*c+o*f-a*h,this.y=n+l*h+a*c-r*f,this.z=s+l*f+r*h-o*c,this}project(t){return this.applyMatrix4(t.matrixWorldInverse).applyMatrix4(t.projectionMatrix)}unproject(t){return this.applyMatrix4(t.projectionMatrixInverse).applyMatrix4(t.matrixWorld)}transformDirection(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[4]*n+r[8]*s,this.y=r[1]*e+r[5]*n+r[9]*s,this.z=r[2]*e+r[6]*n+r[10]*s,this.normalize()}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this}divideScalar(t){return this.multiplyScalar(1/t)}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this}clamp(t,e){return this.x=Math.max(t.x,Math.min(e.x,this.x)),this.y=Math.max(t.y,Math.min(e.y,this.y)),this.z=Math.max(t.z,Math.min(e.z,this.z)),this}clampScalar(t,e){return this.x=Math.max(t,Math.min(e,this.x)),this.y=Math.max(t,Math.min(e,this.y)),this.z=Math.max(t,Math.min(e,this.z)),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(Math.max(t,Math.min(e,n)))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this}cross(t){return this.crossVectors(this,t)}crossVectors(t,e){let n=t.x,s=t.y,r=t.z,o=e.x,a=e.y,l=e.z;return this.x=s*l-r*a,this.y=r*o-n*l,this.z=n*a-s*o,this}projectOnVector(t){let e=t.lengthSq();if(e===0)return this.set(0,0,0);let n=t.dot(this)/e;return this.copy(t).multiplyScalar(n)}projectOnPlane(t){return Qc.copy(this).projectOnVector(t),this.sub(Qc)}reflect(t){return this.sub(Qc.copy(t).multiplyScalar(2*this.dot(t)))}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(nn(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y,s=this.z-t.z;return e*e+n*n+s*s}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)+Math.abs(this.z-t.z)}setFromSpherical(t){return this.setFromSphericalCoords(t.radius,t.phi,t.theta)}setFromSphericalCoords(t,e,n){let s=Math.sin(e)*t;return this.x=s*Math.sin(n),this.y=Math.cos(e)*t,this.z=s*Math.cos(n),this}setFromCylindrical(t){return this.setFromCylindricalCoords(t.radius,t.theta,t.y)}setFromCylindricalCoords(t,e,n){return this.x=t*Math.sin(e),this.y=n,this.z=t*Math.cos(e),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this}setFromMatrixScale(t){let e=this.setFromMatrixColumn(t,0).length(),n=this.setFromMatrixColumn(t,1).length(),s=this.setFromMatrixColumn(t,2).length();return this.x=e,this.y=n,this.z=s,this}setFromMatrixColumn(t,e){return this.fromArray(t.elements,e*4)}setFromMatrix3Column(t,e){return this.fromArray(t.elements,e*3)}setFromEuler(t){return this.x=t._x,this.y=t._y,this.z=t._z,this}setFromColor(t){return this.x=t.r,this.y=t.g,this.z=t.b,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let t=Math.random()*Math.PI*2,e=Math.random()*2-1,n=Math.sqrt(1-e*e);return this.x=n*Math.cos(t),this.y=e,this.z=n*Math.sin(t),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},Qc=new D,ip=new kn,Vn=class{constructor(t=new D(1/0,1/0,1/0),e=new D(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=t,this.max=e}set(t,e){return this.min.copy(t),this.max.copy(e),this}setFromArray(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e+=3)this.expandByPoint(gi.fromArray(t,e));return this}setFromBufferAttribute(t){this.makeEmpty();for(let e=0,n=t.count;e<n;e++)this.expandByPoint(gi.fromBufferAttribute(t,e));return this}setFromPoints(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e++)this.expandByPoint(t[e]);return this}setFromCenterAndSize(t,e){let n=gi.copy(e).multiplyScalar(.5);return this.min.copy(t).sub(n),this.max.copy(t).add(n),this}setFromObject(t,e=!1){return this.makeEmpty(),this.expandByObject(t,e)}clone(){return new this.constructor().copy(this)}copy(t){return this.min.copy(t.min),this.max.copy(t.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(t){return this.isEmpty()?t.set(0,0,0):t.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(t){return this.isEmpty()?t.set(0,0,0):t.subVectors(this.max,this.min)}expandByPoint(t){return this.min.min(t),this.max.max(t),this}expandByVector(t){return this.min.sub(t),this.max.add(t),this}expandByScalar(t){return this.min.addScalar(-t),this.max.addScalar(t),this}expandByObject(t,e=!1){t.updateWorldMatrix(!1,!1);let n=t.geometry;if(n!==void 0){let r=n.getAttribute("position");if(e===!0&&r!==void 0&&t.isInstancedMesh!==!0)for(let o=0,a=r.count;o<a;o++)t.isMesh===!0?t.getVertexPosition(o,gi):gi.fromBufferAttribute(r,o),gi.applyMatrix4(t.matrixWorld),this.expandByPoint(gi);else t.boundingBox!==void 0?(t.boundingBox===null&&t.computeBoundingBox(),ba.copy(t.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),ba.copy(n.boundingBox)),ba.applyMatrix4(t.matrixWorld),this.union(ba)}let s=t.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],e);return this}containsPoint(t){return t.x>=this.min.x&&t.x<=this.max.x&&t.y>=this.min.y&&t.y<=this.max.y&&t.z>=this.min.z&&t.z<=this.max.z}containsBox(t){return this.min.x<=t.min.x&&t.max.x<=this.max.x&&this.min.y<=t.min.y&&t.max.y<=this.max.y&&this.min.z<=t.min.z&&t.max.z<=this.max.z}getParameter(t,e){return e.set((t.x-this.min.x)/(this.max.x-this.min.x),(t.y-this.min.y)/(this.max.y-this.min.y),(t.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(t){return t.max.x>=this.min.x&&t.min.x<=this.max.x&&t.max.y>=this.min.y&&t.min.y<=this.max.y&&t.max.z>=this.min.z&&t.min.z<=this.max.z}intersectsSphere(t){return this.clampPoint(t.center,gi),gi.distanceToSquared(t.center)<=t.radius*t.radius}intersectsPlane(t){let e,n;return t.normal.x>0?(e=t.normal.x*this.min.x,n=t.normal.x*this.max.x):(e=t.normal.x*this.max.x,n=t.normal.x*this.min.x),t.normal.y>0?(e+=t.normal.y*this.min.y,n+=t.normal.y*this.max.y):(e+=t.normal.y*this.max.y,n+=t.normal.y*this.min.y),t.normal.z>0?(e+=t.normal.z*this.min.z,n+=t.normal.z*this.max.z):(e+=t.normal.z*this.max.z,n+=t.normal.z*this.min.z),e<=-t.constant&&n>=-t.constant}intersectsTriangle(t){if(this.isEmpty())return!1;this.getCenter(Ao),Sa.subVectors(this.max,Ao),Rr.subVectors(t.a,Ao),Pr.subVectors(t.b,Ao),Ir.subVectors(t.c,Ao),bs.subVectors(Pr,Rr),Ss.subVectors(Ir,Pr),Ws.subVectors(Rr,Ir);let e=[0,-bs.z,bs.y,0,-Ss.z,Ss.y,0,-Ws.z,Ws.y,bs.z,0,-bs.x,Ss.z,0,-Ss.x,Ws.z,0,-Ws.x,-bs.y,bs.x,0,-Ss.y,Ss.x,0,-Ws.y,Ws.x,0];return!th(e,Rr,Pr,Ir,Sa)||(e=[1,0,0,0,1,0,0,0,1],!th(e,Rr,Pr,Ir,Sa))?!1:(wa.crossVectors(bs,Ss),e=[wa.x,wa.y,wa.z],th(e,Rr,Pr,Ir,Sa))}clampPoint(t,e){return e.copy(t).clamp(this.min,this.max)}distanceToPoint(t){return this.clampPoint(t,gi).distanceTo(t)}getBoundingSphere(t){return this.isEmpty()?t.makeEmpty():(this.getCenter(t.center),t.radius=this.getSize(gi).length()*.5),t}intersect(t){return this.min.max(t.min),this.max.min(t.max),this.isEmpty()&&this.makeEmpty(),this}union(t){return this.min.min(t.min),this.max.max(t.max),this}applyMatrix4(t){return this.isEmpty()?this:(Qi[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(t),Qi[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(t),Qi[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(t),Qi[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(t),Qi[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(t),Qi[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(t),Qi[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(t),Qi[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(t),this.setFromPoints(Qi),this)}translate(t){return this.min.add(t),this.max.add(t),this}equals(t){return t.min.equals(this.min)&&t.max.equals(this.max)}},Qi=[new D,new D,new D,new D,new D,new D,new D,new D],gi=new D,ba=new Vn,Rr=new D,Pr=new D,Ir=new D,bs=new D,Ss=new D,Ws=new D,Ao=new D,Sa=new D,wa=new D,Xs=new D;function th(i,t,e,n,s){for(let r=0,o=i.length-3;r<=o;r+=3){Xs.fromArray(i,r);let a=s.x*Math.abs(Xs.x)+s.y*Math.abs(Xs.y)+s.z*Math.abs(Xs.z),l=t.dot(Xs),c=e.dot(Xs),h=n.dot(Xs);if(Math.max(-Math.max(l,c,h),Math.min(l,c,h))>a)return!1}return!0}var Bx=new Vn,Co=new D,eh=new D,zi=class{constructor(t=new D,e=-1){this.isSphere=!0,this.center=t,this.radius=e}set(t,e){return this.center.copy(t),this.radius=e,this}setFromPoints(t,e){let n=this.center;e!==void 0?n.copy(e):Bx.setFromPoints(t).getCenter(n);let s=0;for(let r=0,o=t.length;r<o;r++)s=Math.max(s,n.distanceToSquared(t[r]));return this.radius=Math.sqrt(s),this}copy(t){return this.center.copy(t.center),this.radius=t.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(t){return t.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(t){return t.distanceTo(this.center)-this.radius}intersectsSphere(t){let e=this.radius+t.radius;return t.center.distanceToSquared(this.center)<=e*e}intersectsBox(t){return t.intersectsSphere(this)}intersectsPlane(t){return Math.abs(t.distanceToPoint(this.center))<=this.radius}clampPoint(t,e){let n=this.center.distanceToSquared(t);return e.copy(t),n>this.radius*this.radius&&(e.sub(this.center).normalize(),e.multiplyScalar(this.radius).add(this.center)),e}getBoundingBox(t){return this.isEmpty()?(t.makeEmpty(),t):(t.set(this.center,this.center),t.expandByScalar(this.radius),t)}applyMatrix4(t){return this.center.applyMatrix4(t),this.radius=this.radius*t.getMaxScaleOnAxis(),this}translate(t){return this.center.add(t),this}expandByPoint(t){if(this.isEmpty())return this.center.copy(t),this.radius=0,this;Co.subVectors(t,this.center);let e=Co.lengthSq();if(e>this.radius*this.radius){let n=Math.sqrt(e),s=(n-this.radius)*.5;this.center.addScaledVector(Co,s/n),this.radius+=s}return this}union(t){return t.isEmpty()?this:this.isEmpty()?(this.copy(t),this):(this.center.equals(t.center)===!0?this.radius=Math.max(this.radius,t.radius):(eh.subVectors(t.center,this.center).setLength(t.radius),this.expandByPoint(Co.copy(t.center).add(eh)),this.expandByPoint(Co.copy(t.center).sub(eh))),this)}equals(t){return t.center.equals(this.center)&&t.radius===this.radius}clone(){return new this.constructor().copy(this)}},ts=new D,nh=new D,Ea=new D,ws=new D,ih=new D,Ta=new D,sh=new D,nr=class{constructor(t=new D,e=new D(0,0,-1)){this.origin=t,this.direction=e}set(t,e){return this.origin.copy(t),this.direction.copy(e),this}copy(t){return this.origin.copy(t.origin),this.direction.copy(t.direction),this}at(t,e){return e.copy(this.origin).addScaledVector(this.direction,t)}lookAt(t){return this.direction.copy(t).sub(this.origin).normalize(),this}recast(t){return this.origin.copy(this.at(t,ts)),this}closestPointToPoint(t,e){e.subVectors(t,this.origin);let n=e.dot(this.direction);return n<0?e.copy(this.origin):e.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(t){return Math.sqrt(this.distanceSqToPoint(t))}distanceSqToPoint(t){let e=ts.subVectors(t,this.origin).dot(this.direction);return e<0?this.origin.distanceToSquared(t):(ts.copy(this.origin).addScaledVector(this.direction,e),ts.distanceToSquared(t))}distanceSqToSegment(t,e,n,s){nh.copy(t).add(e).multiplyScalar(.5),Ea.copy(e).sub(t).normalize(),ws.copy(this.origin).sub(nh);let r=t.distanceTo(e)*.5,o=-this.direction.dot(Ea),a=ws.dot(this.direction),l=-ws.dot(Ea),c=ws.lengthSq(),h=Math.abs(1-o*o),f,u,d,m;if(h>0)if(f=o*l-a,u=o*a-l,m=r*h,f>=0)if(u>=-m)if(u<=m){let _=1/h;f*=_,u*=_,d=f*(f+o*u+2*a)+u*(o*f+u+2*l)+c}else u=r,f=Math.max(0,-(o*u+a)),d=-f*f+u*(u+2*l)+c;else u=-r,f=Math.max(0,-(o*u+a)),d=-f*f+u*(u+2*l)+c;else u<=-m?(f=Math.max(0,-(-o*r+a)),u=f>0?-r:Math.min(Math.max(-r,-l),r),d=-f*f+u*(u+2*l)+c):u<=m?(f=0,u=Math.min(Math.max(-r,-l),r),d=u*(u+2*l)+c):(f=Math.max(0,-(o*r+a)),u=f>0?r:Math.min(Math.max(-r,-l),r),d=-f*f+u*(u+2*l)+c);else u=o>0?-r:r,f=Math.max(0,-(o*u+a)),d=-f*f+u*(u+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,f),s&&s.copy(nh).addScaledVector(Ea,u),d}intersectSphere(t,e){ts.subVectors(t.center,this.origin);let n=ts.dot(this.direction),s=ts.dot(ts)-n*n,r=t.radius*t.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=n-o,l=n+o;return l<0?null:a<0?this.at(l,e):this.at(a,e)}intersectsSphere(t){return this.distanceSqToPoint(t.center)<=t.radius*t.radius}distanceToPlane(t){let e=t.normal.dot(this.direction);if(e===0)return t.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(t.normal)+t.constant)/e;return n>=0?n:null}intersectPlane(t,e){let n=this.distanceToPlane(t);return n===null?null:this.at(n,e)}intersectsPlane(t){let e=t.distanceToPoint(this.origin);return e===0||t.normal.dot(this.direction)*e<0}intersectBox(t,e){let n,s,r,o,a,l,c=1/this.direction.x,h=1/this.direction.y,f=1/this.direction.z,u=this.origin;return c>=0?(n=(t.min.x-u.x)*c,s=(t.max.x-u.x)*c):(n=(t.max.x-u.x)*c,s=(t.min.x-u.x)*c),h>=0?(r=(t.min.y-u.y)*h,o=(t.max.y-u.y)*h):(r=(t.max.y-u.y)*h,o=(t.min.y-u.y)*h),n>o||r>s||((r>n||isNaN(n))&&(n=r),(o<s||isNaN(s))&&(s=o),f>=0?(a=(t.min.z-u.z)*f,l=(t.max.z-u.z)*f):(a=(t.max.z-u.z)*f,l=(t.min.z-u.z)*f),n>l||a>s)||((a>n||n!==n)&&(n=a),(l<s||s!==s)&&(s=l),s<0)?null:this.at(n>=0?n:s,e)}intersectsBox(t){return this.intersectBox(t,ts)!==null}intersectTriangle(t,e,n,s,r){ih.subVectors(e,t),Ta.subVectors(n,t),sh.crossVectors(ih,Ta);let o=this.direction.dot(sh),a;if(o>0){if(s)return null;a=1}else if(o<0)a=-1,o=-o;else return null;ws.subVectors(this.origin,t);let l=a*this.direction.dot(Ta.crossVectors(ws,Ta));if(l<0)return null;let c=a*this.direction.dot(ih.cross(ws));if(c<0||l+c>o)return null;let h=-a*ws.dot(sh);return h<0?null:this.at(h/o,r)}applyMatrix4(t){return this.origin.applyMatrix4(t),this.direction.transformDirection(t),this}equals(t){return t.origin.equals(this.origin)&&t.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},ze=class i{constructor(t,e,n,s,r,o,a,l,c,h,f,u,d,m,_,g){i.prototype.isMatrix4=!0,this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c,h,f,u,d,m,_,g)}set(t,e,n,s,r,o,a,l,c,h,f,u,d,m,_,g){let p=this.elements;return p[0]=t,p[4]=e,p[8]=n,p[12]=s,p[1]=r,p[5]=o,p[9]=a,p[13]=l,p[2]=c,p[6]=h,p[10]=f,p[14]=u,p[3]=d,p[7]=m,p[11]=_,p[15]=g,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new i().fromArray(this.elements)}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],e[9]=n[9],e[10]=n[10],e[11]=n[11],e[12]=n[12],e[13]=n[13],e[14]=n[14],e[15]=n[15],this}copyPosition(t){let e=this.elements,n=t.elements;return e[12]=n[12],e[13]=n[13],e[14]=n[14],this}setFromMatrix3(t){let e=t.elements;return this.set(e[0],e[3],e[6],0,e[1],e[4],e[7],0,e[2],e[5],e[8],0,0,0,0,1),this}extractBasis(t,e,n){return t.setFromMatrixColumn(this,0),e.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this}makeBasis(t,e,n){return this.set(t.x,e.x,n.x,0,t.y,e.y,n.y,0,t.z,e.z,n.z,0,0,0,0,1),this}extractRotation(t){let e=this.elements,n=t.elements,s=1/Lr.setFromMatrixColumn(t,0).length(),r=1/Lr.setFromMatrixColumn(t,1).length(),o=1/Lr.setFromMatrixColumn(t,2).length();return e[0]=n[0]*s,e[1]=n[1]*s,e[2]=n[2]*s,e[3]=0,e[4]=n[4]*r,e[5]=n[5]*r,e[6]=n[6]*r,e[7]=0,e[8]=n[8]*o,e[9]=n[9]*o,e[10]=n[10]*o,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromEuler(t){let e=this.elements,n=t.x,s=t.y,r=t.z,o=Math.cos(n),a=Math.sin(n),l=Math.cos(s),c=Math.sin(s),h=Math.cos(r),f=Math.sin(r);if(t.order==="XYZ"){let u=o*h,d=o*f,m=a*h,_=a*f;e[0]=l*h,e[4]=-l*f,e[8]=c,e[1]=d+m*c,e[5]=u-_*c,e[9]=-a*l,e[2]=_-u*c,e[6]=m+d*c,e[10]=o*l}else if(t.order==="YXZ"){let u=l*h,d=l*f,m=c*h,_=c*f;e[0]=u+_*a,e[4]=m*a-d,e[8]=o*c,e[1]=o*f,e[5]=o*h,e[9]=-a,e[2]=d*a-m,e[6]=_+u*a,e[10]=o*l}else if(t.order==="ZXY"){let u=l*h,d=l*f,m=c*h,_=c*f;e[0]=u-_*a,e[4]=-o*f,e[8]=m+d*a,e[1]=d+m*a,e[5]=o*h,e[9]=_-u*a,e[2]=-o*c,e[6]=a,e[10]=o*l}else if(t.order==="ZYX"){let u=o*h,d=o*f,m=a*h,_=a*f;e[0]=l*h,e[4]=m*c-d,e[8]=u*c+_,e[1]=l*f,e[5]=_*c+u,e[9]=d*c-m,e[2]=-c,e[6]=a*l,e[10]=o*l}else if(t.order==="YZX"){let u=o*l,d=o*c,m=a*l,_=a*c;e[0]=l*h,e[4]=_-u*f,e[8]=m*f+d,e[1]=f,e[5]=o*h,e[9]=-a*h,e[2]=-c*h,e[6]=d*f+m,e[10]=u-_*f}else if(t.order==="XZY"){let u=o*l,d=o*c,m=a*l,_=a*c;e[0]=l*h,e[4]=-f,e[8]=c*h,e[1]=u*f+_,e[5]=o*h,e[9]=d*f-m,e[2]=m*f-d,e[6]=a*h,e[10]=_*f+u}return e[3]=0,e[7]=0,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromQuaternion(t){return this.compose(zx,t,kx)}lookAt(t,e,n){let s=this.elements;return Xn.subVectors(t,e),Xn.lengthSq()===0&&(Xn.z=1),Xn.normalize(),Es.crossVectors(n,Xn),Es.lengthSq()===0&&(Math.abs(n.z)===1?Xn.x+=1e-4:Xn.z+=1e-4,Xn.normalize(),Es.crossVectors(n,Xn)),Es.normalize(),Aa.crossVectors(Xn,Es),s[0]=Es.x,s[4]=Aa.x,s[8]=Xn.x,s[1]=Es.y,s[5]=Aa.y,s[9]=Xn.y,s[2]=Es.z,s[6]=Aa.z,s[10]=Xn.z,this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[4],l=n[8],c=n[12],h=n[1],f=n[5],u=n[9],d=n[13],m=n[2],_=n[6],g=n[10],p=n[14],S=n[3],v=n[7],y=n[11],U=n[15],R=s[0],P=s[4],F=s[8],E=s[12],M=s[1],A=s[5],W=s[9],G=s[13],X=s[2],Z=s[6],Y=s[10],nt=s[14],Q=s[3],dt=s[7],at=s[11],_t=s[15];return r[0]=o*R+a*M+l*X+c*Q,r[4]=o*P+a*A+l*Z+c*dt,r[8]=o*F+a*W+l*Y+c*at,r[12]=o*E+a*G+l*nt+c*_t,r[1]=h*R+f*M+u*X+d*Q,r[5]=h*P+f*A+u*Z+d*dt,r[9]=h*F+f*W+u*Y+d*at,r[13]=h*E+f*G+u*nt+d*_t,r[2]=m*R+_*M+g*X+p*Q,r[6]=m*P+_*A+g*Z+p*dt,r[10]=m*F+_*W+g*Y+p*at,r[14]=m*E+_*G+g*nt+p*_t,r[3]=S*R+v*M+y*X+U*Q,r[7]=S*P+v*A+y*Z+U*dt,r[11]=S*F+v*W+y*Y+U*at,r[15]=S*E+v*G+y*nt+U*_t,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[4]*=t,e[8]*=t,e[12]*=t,e[1]*=t,e[5]*=t,e[9]*=t,e[13]*=t,e[2]*=t,e[6]*=t,e[10]*=t,e[14]*=t,e[3]*=t,e[7]*=t,e[11]*=t,e[15]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[12],o=t[1],a=t[5],l=t[9],c=t[13],h=t[2],f=t[6],u=t[10],d=t[14],m=t[3],_=t[7],g=t[11],p=t[15];return m*(+r*l*f-s*c*f-r*a*u+n*c*u+s*a*d-n*l*d)+_*(+e*l*d-e*c*u+r*o*u-s*o*d+s*c*h-r*l*h)+g*(+e*c*f-e*a*d-r*o*f+n*o*d+r*a*h-n*c*h)+p*(-s*a*h-e*l*f+e*a*u+s*o*f-n*o*u+n*l*h)}transpose(){let t=this.elements,e;return e=t[1],t[1]=t[4],t[4]=e,e=t[2],t[2]=t[8],t[8]=e,e=t[6],t[6]=t[9],t[9]=e,e=t[3],t[3]=t[12],t[12]=e,e=t[7],t[7]=t[13],t[13]=e,e=t[11],t[11]=t[14],t[14]=e,this}setPosition(t,e,n){let s=this.elements;return t.isVector3?(s[12]=t.x,s[13]=t.y,s[14]=t.z):(s[12]=t,s[13]=e,s[14]=n),this}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],f=t[9],u=t[10],d=t[11],m=t[12],_=t[13],g=t[14],p=t[15],S=f*g*c-_*u*c+_*l*d-a*g*d-f*l*p+a*u*p,v=m*u*c-h*g*c-m*l*d+o*g*d+h*l*p-o*u*p,y=h*_*c-m*f*c+m*a*d-o*_*d-h*a*p+o*f*p,U=m*f*l-h*_*l-m*a*u+o*_*u+h*a*g-o*f*g,R=e*S+n*v+s*y+r*U;if(R===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let P=1/R;return t[0]=S*P,t[1]=(_*u*r-f*g*r-_*s*d+n*g*d+f*s*p-n*u*p)*P,t[2]=(a*g*r-_*l*r+_*s*c-n*g*c-a*s*p+n*l*p)*P,t[3]=(f*l*r-a*u*r-f*s*c+n*u*c+a*s*d-n*l*d)*P,t[4]=v*P,t[5]=(h*g*r-m*u*r+m*s*d-e*g*d-h*s*p+e*u*p)*P,t[6]=(m*l*r-o*g*r-m*s*c+e*g*c+o*s*p-e*l*p)*P,t[7]=(o*u*r-h*l*r+h*s*c-e*u*c-o*s*d+e*l*d)*P,t[8]=y*P,t[9]=(m*f*r-h*_*r-m*n*d+e*_*d+h*n*p-e*f*p)*P,t[10]=(o*_*r-m*a*r+m*n*c-e*_*c-o*n*p+e*a*p)*P,t[11]=(h*a*r-o*f*r-h*n*c+e*f*c+o*n*d-e*a*d)*P,t[12]=U*P,t[13]=(h*_*s-m*f*s+m*n*u-e*_*u-h*n*g+e*f*g)*P,t[14]=(m*a*s-o*_*s-m*n*l+e*_*l+o*n*g-e*a*g)*P,t[15]=(o*f*s-h*a*s+h*n*l-e*f*l-o*n*u+e*a*u)*P,this}scale(t){let e=this.elements,n=t.x,s=t.y,r=t.z;return e[0]*=n,e[4]*=s,e[8]*=r,e[1]*=n,e[5]*=s,e[9]*=r,e[2]*=n,e[6]*=s,e[10]*=r,e[3]*=n,e[7]*=s,e[11]*=r,this}getMaxScaleOnAxis(){let t=this.elements,e=t[0]*t[0]+t[1]*t[1]+t[2]*t[2],n=t[4]*t[4]+t[5]*t[5]+t[6]*t[6],s=t[8]*t[8]+t[9]*t[9]+t[10]*t[10];return Math.sqrt(Math.max(e,n,s))}makeTranslation(t,e,n){return t.isVector3?this.set(1,0,0,t.x,0,1,0,t.y,0,0,1,t.z,0,0,0,1):this.set(1,0,0,t,0,1,0,e,0,0,1,n,0,0,0,1),this}makeRotationX(t){let e=Math.cos(t),n=Math.sin(t);return this.set(1,0,0,0,0,e,-n,0,0,n,e,0,0,0,0,1),this}makeRotationY(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,0,n,0,0,1,0,0,-n,0,e,0,0,0,0,1),this}makeRotationZ(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,0,n,e,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(t,e){let n=Math.cos(e),s=Math.sin(e),r=1-n,o=t.x,a=t.y,l=t.z,c=r*o,h=r*a;return this.set(c*o+n,c*a-s*l,c*l+s*a,0,c*a+s*l,h*a+n,h*l-s*o,0,c*l-s*a,h*l+s*o,r*l*l+n,0,0,0,0,1),this}makeScale(t,e,n){return this.set(t,0,0,0,0,e,0,0,0,0,n,0,0,0,0,1),this}makeShear(t,e,n,s,r,o){return this.set(1,n,r,0,t,1,o,0,e,s,1,0,0,0,0,1),this}compose(t,e,n){let s=this.elements,r=e._x,o=e._y,a=e._z,l=e._w,c=r+r,h=o+o,f=a+a,u=r*c,d=r*h,m=r*f,_=o*h,g=o*f,p=a*f,S=l*c,v=l*h,y=l*f,U=n.x,R=n.y,P=n.z;return s[0]=(1-(_+p))*U,s[1]=(d+y)*U,s[2]=(m-v)*U,s[3]=0,s[4]=(d-y)*R,s[5]=(1-(u+p))*R,s[6]=(g+S)*R,s[7]=0,s[8]=(m+v)*P,s[9]=(g-S)*P,s[10]=(1-(u+_))*P,s[11]=0,s[12]=t.x,s[13]=t.y,s[14]=t.z,s[15]=1,this}decompose(t,e,n){let s=this.elements,r=Lr.set(s[0],s[1],s[2]).length(),o=Lr.set(s[4],s[5],s[6]).length(),a=Lr.set(s[8],s[9],s[10]).length();this.determinant()<0&&(r=-r),t.x=s[12],t.y=s[13],t.z=s[14],_i.copy(this);let c=1/r,h=1/o,f=1/a;return _i.elements[0]*=c,_i.elements[1]*=c,_i.elements[2]*=c,_i.elements[4]*=h,_i.elements[5]*=h,_i.elements[6]*=h,_i.elements[8]*=f,_i.elements[9]*=f,_i.elements[10]*=f,e.setFromRotationMatrix(_i),n.x=r,n.y=o,n.z=a,this}makePerspective(t,e,n,s,r,o,a=os){let l=this.elements,c=2*r/(e-t),h=2*r/(n-s),f=(e+t)/(e-t),u=(n+s)/(n-s),d,m;if(a===os)d=-(o+r)/(o-r),m=-2*o*r/(o-r);else if(a===sl)d=-o/(o-r),m=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return l[0]=c,l[4]=0,l[8]=f,l[12]=0,l[1]=0,l[5]=h,l[9]=u,l[13]=0,l[2]=0,l[6]=0,l[10]=d,l[14]=m,l[3]=0,l[7]=0,l[11]=-1,l[15]=0,this}makeOrthographic(t,e,n,s,r,o,a=os){let l=this.elements,c=1/(e-t),h=1/(n-s),f=1/(o-r),u=(e+t)*c,d=(n+s)*h,m,_;if(a===os)m=(o+r)*f,_=-2*f;else if(a===sl)m=r*f,_=-1*f;else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return l[0]=2*c,l[4]=0,l[8]=0,l[12]=-u,l[1]=0,l[5]=2*h,l[9]=0,l[13]=-d,l[2]=0,l[6]=0,l[10]=_,l[14]=-m,l[3]=0,l[7]=0,l[11]=0,l[15]=1,this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<16;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<16;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t[e+9]=n[9],t[e+10]=n[10],t[e+11]=n[11],t[e+12]=n[12],t[e+13]=n[13],t[e+14]=n[14],t[e+15]=n[15],t}},Lr=new D,_i=new ze,zx=new D(0,0,0),kx=new D(1,1,1),Es=new D,Aa=new D,Xn=new D,sp=new ze,rp=new kn,ki=class i{constructor(t=0,e=0,n=0,s=i.DEFAULT_ORDER){this.isEuler=!0,this._x=t,this._y=e,this._z=n,this._order=s}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get order(){return this._order}set order(t){this._order=t,this._onChangeCallback()}set(t,e,n,s=this._order){return this._x=t,this._y=e,this._z=n,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(t){return this._x=t._x,this._y=t._y,this._z=t._z,this._order=t._order,this._onChangeCallback(),this}setFromRotationMatrix(t,e=this._order,n=!0){let s=t.elements,r=s[0],o=s[4],a=s[8],l=s[1],c=s[5],h=s[9],f=s[2],u=s[6],d=s[10];switch(e){case"XYZ":this._y=Math.asin(nn(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,d),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(u,c),this._z=0);break;case"YXZ":this._x=Math.asin(-nn(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,d),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-f,r),this._z=0);break;case"ZXY":this._x=Math.asin(nn(u,-1,1)),Math.abs(u)<.9999999?(this._y=Math.atan2(-f,d),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-nn(f,-1,1)),Math.abs(f)<.9999999?(this._x=Math.atan2(u,d),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(nn(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-f,r)):(this._x=0,this._y=Math.atan2(a,d));break;case"XZY":this._z=Math.asin(-nn(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(u,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,d),this._y=0);break;default:console.warn("THREE.Euler: .setFromRotationMatrix() encountered an unknown order: "+e)}return this._order=e,n===!0&&this._onChangeCallback(),this}setFromQuaternion(t,e,n){return sp.makeRotationFromQuaternion(t),this.setFromRotationMatrix(sp,e,n)}setFromVector3(t,e=this._order){return this.set(t.x,t.y,t.z,e)}reorder(t){return rp.setFromEuler(this),this.setFromQuaternion(rp,t)}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._order===this._order}fromArray(t){return this._x=t[0],this._y=t[1],this._z=t[2],t[3]!==void 0&&(this._order=t[3]),this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._order,t}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};ki.DEFAULT_ORDER="XYZ";var ko=class{constructor(){this.mask=1}set(t){this.mask=(1<<t|0)>>>0}enable(t){this.mask|=1<<t|0}enableAll(){this.mask=-1}toggle(t){this.mask^=1<<t|0}disable(t){this.mask&=~(1<<t|0)}disableAll(){this.mask=0}test(t){return(this.mask&t.mask)!==0}isEnabled(t){return(this.mask&(1<<t|0))!==0}},Vx=0,op=new D,Dr=new kn,es=new ze,Ca=new D,Ro=new D,Hx=new D,Gx=new kn,ap=new D(1,0,0),lp=new D(0,1,0),cp=new D(0,0,1),hp={type:"added"},Wx={type:"removed"},Ur={type:"childadded",child:null},rh={type:"childremoved",child:null},En=class i extends cs{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:Vx++}),this.uuid=Bi(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=i.DEFAULT_UP.clone();let t=new D,e=new ki,n=new kn,s=new D(1,1,1);function r(){n.setFromEuler(e,!1)}function o(){e.setFromQuaternion(n,void 0,!1)}e._onChange(r),n._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:t},rotation:{configurable:!0,enumerable:!0,value:e},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new ze},normalMatrix:{value:new le}}),this.matrix=new ze,this.matrixWorld=new ze,this.matrixAutoUpdate=i.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=i.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new ko,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.userData={}}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(t){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(t),this.matrix.decompose(this.position,this.quaternion,this.scale)}applyQuaternion(t){return this.quaternion.premultiply(t),this}setRotationFromAxisAngle(t,e){this.quaternion.setFromAxisAngle(t,e)}setRotationFromEuler(t){this.quaternion.setFromEuler(t,!0)}setRotationFromMatrix(t){this.quaternion.setFromRotationMatrix(t)}setRotationFromQuaternion(t){this.quaternion.copy(t)}rotateOnAxis(t,e){return Dr.setFromAxisAngle(t,e),this.quaternion.multiply(Dr),this}rotateOnWorldAxis(t,e){return Dr.setFromAxisAngle(t,e),this.quaternion.premultiply(Dr),this}rotateX(t){return this.rotateOnAxis(ap,t)}rotateY(t){return this.rotateOnAxis(lp,t)}rotateZ(t){return this.rotateOnAxis(cp,t)}translateOnAxis(t,e){return op.copy(t).applyQuaternion(this.quaternion),this.position.add(op.multiplyScalar(e)),this}translateX(t){return this.translateOnAxis(ap,t)}translateY(t){return this.translateOnAxis(lp,t)}translateZ(t){return this.translateOnAxis(cp,t)}localToWorld(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(this.matrixWorld)}worldToLocal(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(es.copy(this.matrixWorld).invert())}lookAt(t,e,n){t.isVector3?Ca.copy(t):Ca.set(t,e,n);let s=this.parent;this.updateWorldMatrix(!0,!1),Ro.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?es.lookAt(Ro,Ca,this.up):es.lookAt(Ca,Ro,this.up),this.quaternion.setFromRotationMatrix(es),s&&(es.extractRotation(s.matrixWorld),Dr.setFromRotationMatrix(es),this.quaternion.premultiply(Dr.invert()))}add(t){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.add(arguments[e]);return this}return t===this?(console.error("THREE.Object3D.add: object can't be added as a child of itself.",t),this):(t&&t.isObject3D?(t.removeFromParent(),t.parent=this,this.children.push(t),t.dispatchEvent(hp),Ur.child=t,this.dispatchEvent(Ur),Ur.child=null):console.error("THREE.Object3D.add: object not an instance of THREE.Object3D.",t),this)}remove(t){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}let e=this.children.indexOf(t);return e!==-1&&(t.parent=null,this.children.splice(e,1),t.dispatchEvent(Wx),rh.child=t,this.dispatchEvent(rh),rh.child=null),this}removeFromParent(){let t=this.parent;return t!==null&&t.remove(this),this}clear(){return this.remove(...this.children)}attach(t){return this.updateWorldMatrix(!0,!1),es.copy(this.matrixWorld).invert(),t.parent!==null&&(t.parent.updateWorldMatrix(!0,!1),es.multiply(t.parent.matrixWorld)),t.applyMatrix4(es),t.removeFromParent(),t.parent=this,this.children.push(t),t.updateWorldMatrix(!1,!0),t.dispatchEvent(hp),Ur.child=t,this.dispatchEvent(Ur),Ur.child=null,this}getObjectById(t){return this.getObjectByProperty("id",t)}getObjectByName(t){return this.getObjectByProperty("name",t)}getObjectByProperty(t,e){if(this[t]===e)return this;for(let n=0,s=this.children.length;n<s;n++){let o=this.children[n].getObjectByProperty(t,e);if(o!==void 0)return o}}getObjectsByProperty(t,e,n=[]){this[t]===e&&n.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(t,e,n);return n}getWorldPosition(t){return this.updateWorldMatrix(!0,!1),t.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ro,t,Hx),t}getWorldScale(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ro,Gx,t),t}getWorldDirection(t){this.updateWorldMatrix(!0,!1);let e=this.matrixWorld.elements;return t.set(e[8],e[9],e[10]).normalize()}raycast(){}traverse(t){t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverse(t)}traverseVisible(t){if(this.visible===!1)return;t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverseVisible(t)}traverseAncestors(t){let e=this.parent;e!==null&&(t(e),e.traverseAncestors(t))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale),this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(t){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||t)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,t=!0);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].updateMatrixWorld(t)}updateWorldMatrix(t,e){let n=this.parent;if(t===!0&&n!==null&&n.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),e===!0){let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].updateWorldMatrix(!1,!0)}}toJSON(t){let e=t===void 0||typeof t=="string",n={};e&&(t={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.6,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,this.name!==""&&(s.name=this.name),this.castShadow===!0&&(s.castShadow=!0),this.receiveShadow===!0&&(s.receiveShadow=!0),this.visible===!1&&(s.visible=!1),this.frustumCulled===!1&&(s.frustumCulled=!1),this.renderOrder!==0&&(s.renderOrder=this.renderOrder),Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.matrixAutoUpdate===!1&&(s.matrixAutoUpdate=!1),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.visibility=this._visibility,s.active=this._active,s.bounds=this._bounds.map(a=>({boxInitialized:a.boxInitialized,boxMin:a.box.min.toArray(),boxMax:a.box.max.toArray(),sphereInitialized:a.sphereInitialized,sphereRadius:a.sphere.radius,sphereCenter:a.sphere.center.toArray()})),s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.geometryCount=this._geometryCount,s.matricesTexture=this._matricesTexture.toJSON(t),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(t)),this.boundingSphere!==null&&(s.boundingSphere={center:s.boundingSphere.center.toArray(),radius:s.boundingSphere.radius}),this.boundingBox!==null&&(s.boundingBox={min:s.boundingBox.min.toArray(),max:s.boundingBox.max.toArray()}));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(t)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(t).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(t).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(t.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){let f=l[c];r(t.shapes,f)}else r(t.shapes,l)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(t.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(t.materials,this.material[l]));s.material=a}else s.material=r(t.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(t).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];s.animations.push(r(t.animations,l))}}if(e){let a=o(t.geometries),l=o(t.materials),c=o(t.textures),h=o(t.images),f=o(t.shapes),u=o(t.skeletons),d=o(t.animations),m=o(t.nodes);a.length>0&&(n.geometries=a),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),h.length>0&&(n.images=h),f.length>0&&(n.shapes=f),u.length>0&&(n.skeletons=u),d.length>0&&(n.animations=d),m.length>0&&(n.nodes=m)}return n.object=s,n;function o(a){let l=[];for(let c in a){let h=a[c];delete h.metadata,l.push(h)}return l}}clone(t){return new this.constructor().copy(this,t)}copy(t,e=!0){if(this.name=t.name,this.up.copy(t.up),this.position.copy(t.position),this.rotation.order=t.rotation.order,this.quaternion.copy(t.quaternion),this.scale.copy(t.scale),this.matrix.copy(t.matrix),this.matrixWorld.copy(t.matrixWorld),this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrixWorldAutoUpdate=t.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=t.matrixWorldNeedsUpdate,this.layers.mask=t.layers.mask,this.visible=t.visible,this.castShadow=t.castShadow,this.receiveShadow=t.receiveShadow,this.frustumCulled=t.frustumCulled,this.renderOrder=t.renderOrder,this.animations=t.animations.slice(),this.userData=JSON.parse(JSON.stringify(t.userData)),e===!0)for(let n=0;n<t.children.length;n++){let s=t.children[n];this.add(s.clone())}return this}};En.DEFAULT_UP=new D(0,1,0);En.DEFAULT_MATRIX_AUTO_UPDATE=!0;En.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var xi=new D,ns=new D,oh=new D,is=new D,Nr=new D,Fr=new D,up=new D,ah=new D,lh=new D,ch=new D,hh=new De,uh=new De,fh=new De,Fi=class i{constructor(t=new D,e=new D,n=new D){this.a=t,this.b=e,this.c=n}static getNormal(t,e,n,s){s.subVectors(n,e),xi.subVectors(t,e),s.cross(xi);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(t,e,n,s,r){xi.subVectors(s,e),ns.subVectors(n,e),oh.subVectors(t,e);let o=xi.dot(xi),a=xi.dot(ns),l=xi.dot(oh),c=ns.dot(ns),h=ns.dot(oh),f=o*c-a*a;if(f===0)return r.set(0,0,0),null;let u=1/f,d=(c*l-a*h)*u,m=(o*h-a*l)*u;return r.set(1-d-m,m,d)}static containsPoint(t,e,n,s){return this.getBarycoord(t,e,n,s,is)===null?!1:is.x>=0&&is.y>=0&&is.x+is.y<=1}static getInterpolation(t,e,n,s,r,o,a,l){return this.getBarycoord(t,e,n,s,is)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,is.x),l.addScaledVector(o,is.y),l.addScaledVector(a,is.z),l)}static getInterpolatedAttribute(t,e,n,s,r,o){return hh.setScalar(0),uh.setScalar(0),fh.setScalar(0),hh.fromBufferAttribute(t,e),uh.fromBufferAttribute(t,n),fh.fromBufferAttribute(t,s),o.setScalar(0),o.addScaledVector(hh,r.x),o.addScaledVector(uh,r.y),o.addScaledVector(fh,r.z),o}static isFrontFacing(t,e,n,s){return xi.subVectors(n,e),ns.subVectors(t,e),xi.cross(ns).dot(s)<0}set(t,e,n){return this.a.copy(t),this.b.copy(e),this.c.copy(n),this}setFromPointsAndIndices(t,e,n,s){return this.a.copy(t[e]),this.b.copy(t[n]),this.c.copy(t[s]),this}setFromAttributeAndIndices(t,e,n,s){return this.a.fromBufferAttribute(t,e),this.b.fromBufferAttribute(t,n),this.c.fromBufferAttribute(t,s),this}clone(){return new this.constructor().copy(this)}copy(t){return this.a.copy(t.a),this.b.copy(t.b),this.c.copy(t.c),this}getArea(){return xi.subVectors(this.c,this.b),ns.subVectors(this.a,this.b),xi.cross(ns).length()*.5}getMidpoint(t){return t.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(t){return i.getNormal(this.a,this.b,this.c,t)}getPlane(t){return t.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(t,e){return i.getBarycoord(t,this.a,this.b,this.c,e)}getInterpolation(t,e,n,s,r){return i.getInterpolation(t,this.a,this.b,this.c,e,n,s,r)}containsPoint(t){return i.containsPoint(t,this.a,this.b,this.c)}isFrontFacing(t){return i.isFrontFacing(this.a,this.b,this.c,t)}intersectsBox(t){return t.intersectsTriangle(this)}closestPointToPoint(t,e){let n=this.a,s=this.b,r=this.c,o,a;Nr.subVectors(s,n),Fr.subVectors(r,n),ah.subVectors(t,n);let l=Nr.dot(ah),c=Fr.dot(ah);if(l<=0&&c<=0)return e.copy(n);lh.subVectors(t,s);let h=Nr.dot(lh),f=Fr.dot(lh);if(h>=0&&f<=h)return e.copy(s);let u=l*f-h*c;if(u<=0&&l>=0&&h<=0)return o=l/(l-h),e.copy(n).addScaledVector(Nr,o);ch.subVectors(t,r);let d=Nr.dot(ch),m=Fr.dot(ch);if(m>=0&&d<=m)return e.copy(r);let _=d*c-l*m;if(_<=0&&c>=0&&m<=0)return a=c/(c-m),e.copy(n).addScaledVector(Fr,a);let g=h*m-d*f;if(g<=0&&f-h>=0&&d-m>=0)return up.subVectors(r,s),a=(f-h)/(f-h+(d-m)),e.copy(s).addScaledVector(up,a);let p=1/(g+_+u);return o=_*p,a=u*p,e.copy(n).addScaledVector(Nr,o).addScaledVector(Fr,a)}equals(t){return t.a.equals(this.a)&&t.b.equals(this.b)&&t.c.equals(this.c)}},xm={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Ts={h:0,s:0,l:0},Ra={h:0,s:0,l:0};function dh(i,t,e){return e<0&&(e+=1),e>1&&(e-=1),e<1/6?i+(t-i)*6*e:e<1/2?t:e<2/3?i+(t-i)*6*(2/3-e):i}var oe=class{constructor(t,e,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(t,e,n)}set(t,e,n){if(e===void 0&&n===void 0){let s=t;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(t,e,n);return this}setScalar(t){return this.r=t,this.g=t,this.b=t,this}setHex(t,e=ri){return t=Math.floor(t),this.r=(t>>16&255)/255,this.g=(t>>8&255)/255,this.b=(t&255)/255,be.toWorkingColorSpace(this,e),this}setRGB(t,e,n,s=be.workingColorSpace){return this.r=t,this.g=e,this.b=n,be.toWorkingColorSpace(this,s),this}setHSL(t,e,n,s=be.workingColorSpace){if(t=uf(t,1),e=nn(e,0,1),n=nn(n,0,1),e===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+e):n+e-n*e,o=2*n-r;this.r=dh(o,r,t+1/3),this.g=dh(o,r,t),this.b=dh(o,r,t-1/3)}return be.toWorkingColorSpace(this,s),this}setStyle(t,e=ri){function n(r){r!==void 0&&parseFloat(r)<1&&console.warn("THREE.Color: Alpha component of "+t+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(t)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d*\.?\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,e);if(r=/^\s*(\d+)\%\s*,\s*(\d+)\%\s*,\s*(\d+)\%\s*(?:,\s*(\d*\.?\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(100,parseInt(r[1],10))/100,Math.min(100,parseInt(r[2],10))/100,Math.min(100,parseInt(r[3],10))/100,e);break;case"hsl":case"hsla":if(r=/^\s*(\d*\.?\d+)\s*,\s*(\d*\.?\d+)\%\s*,\s*(\d*\.?\d+)\%\s*(?:,\s*(\d*\.?\d+)\s*)?$/.exec(a))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,e);break;default:console.warn("THREE.Color: Unknown color model "+t)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(t)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,e);if(o===6)return this.setHex(parseInt(r,16),e);console.warn("THREE.Color: Invalid hex color "+t)}else if(t&&t.length>0)return this.setColorName(t,e);return this}setColorName(t,e=ri){let n=xm[t.toLowerCase()];return n!==void 0?this.setHex(n,e):console.warn("THREE.Color: Unknown color "+t),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(t){return this.r=t.r,this.g=t.g,this.b=t.b,this}copySRGBToLinear(t){return this.r=as(t.r),this.g=as(t.g),this.b=as(t.b),this}copyLinearToSRGB(t){return this.r=qr(t.r),this.g=qr(t.g),this.b=qr(t.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(t=ri){return be.fromWorkingColorSpace(wn.copy(this),t),Math.round(nn(wn.r*255,0,255))*65536+Math.round(nn(wn.g*255,0,255))*256+Math.round(nn(wn.b*255,0,255))}getHexString(t=ri){return("000000"+this.getHex(t).toString(16)).slice(-6)}getHSL(t,e=be.workingColorSpace){be.fromWorkingColorSpace(wn.copy(this),e);let n=wn.r,s=wn.g,r=wn.b,o=Math.max(n,s,r),a=Math.min(n,s,r),l,c,h=(a+o)/2;if(a===o)l=0,c=0;else{let f=o-a;switch(c=h<=.5?f/(o+a):f/(2-o-a),o){case n:l=(s-r)/f+(s<r?6:0);break;case s:l=(r-n)/f+2;break;case r:l=(n-s)/f+4;break}l/=6}return t.h=l,t.s=c,t.l=h,t}getRGB(t,e=be.workingColorSpace){return be.fromWorkingColorSpace(wn.copy(this),e),t.r=wn.r,t.g=wn.g,t.b=wn.b,t}getStyle(t=ri){be.fromWorkingColorSpace(wn.copy(this),t);let e=wn.r,n=wn.g,s=wn.b;return t!==ri?`color(${t} ${e.toFixed(3)} ${n.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(e*255)},${Math.round(n*255)},${Math.round(s*255)})`}offsetHSL(t,e,n){return this.getHSL(Ts),this.setHSL(Ts.h+t,Ts.s+e,Ts.l+n)}add(t){return this.r+=t.r,this.g+=t.g,this.b+=t.b,this}addColors(t,e){return this.r=t.r+e.r,this.g=t.g+e.g,this.b=t.b+e.b,this}addScalar(t){return this.r+=t,this.g+=t,this.b+=t,this}sub(t){return this.r=Math.max(0,this.r-t.r),this.g=Math.max(0,this.g-t.g),this.b=Math.max(0,this.b-t.b),this}multiply(t){return this.r*=t.r,this.g*=t.g,this.b*=t.b,this}multiplyScalar(t){return this.r*=t,this.g*=t,this.b*=t,this}lerp(t,e){return this.r+=(t.r-this.r)*e,this.g+=(t.g-this.g)*e,this.b+=(t.b-this.b)*e,this}lerpColors(t,e,n){return this.r=t.r+(e.r-t.r)*n,this.g=t.g+(e.g-t.g)*n,this.b=t.b+(e.b-t.b)*n,this}lerpHSL(t,e){this.getHSL(Ts),t.getHSL(Ra);let n=Uo(Ts.h,Ra.h,e),s=Uo(Ts.s,Ra.s,e),r=Uo(Ts.l,Ra.l,e);return this.setHSL(n,s,r),this}setFromVector3(t){return this.r=t.x,this.g=t.y,this.b=t.z,this}applyMatrix3(t){let e=this.r,n=this.g,s=this.b,r=t.elements;return this.r=r[0]*e+r[3]*n+r[6]*s,this.g=r[1]*e+r[4]*n+r[7]*s,this.b=r[2]*e+r[5]*n+r[8]*s,this}equals(t){return t.r===this.r&&t.g===this.g&&t.b===this.b}fromArray(t,e=0){return this.r=t[e],this.g=t[e+1],this.b=t[e+2],this}toArray(t=[],e=0){return t[e]=this.r,t[e+1]=this.g,t[e+2]=this.b,t}fromBufferAttribute(t,e){return this.r=t.getX(e),this.g=t.getY(e),this.b=t.getZ(e),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},wn=new oe;oe.NAMES=xm;var Xx=0,Ds=class extends cs{static get type(){return"Material"}get type(){return this.constructor.type}set type(t){}constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:Xx++}),this.uuid=Bi(),this.name="",this.blending=Gr,this.side=Ls,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=Rh,this.blendDst=Ph,this.blendEquation=Ks,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new oe(0,0,0),this.blendAlpha=0,this.depthFunc=$r,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=$d,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=Ar,this.stencilZFail=Ar,this.stencilZPass=Ar,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(t){this._alphaTest>0!=t>0&&this.version++,this._alphaTest=t}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(t){if(t!==void 0)for(let e in t){let n=t[e];if(n===void 0){console.warn(`THREE.Material: parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){console.warn(`THREE.Material: '${e}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(n):s&&s.isVector3&&n&&n.isVector3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";e&&(t={textures:{},images:{}});let n={metadata:{version:4.6,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,this.name!==""&&(n.name=this.name),this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&this.emissiveIntensity!==1&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(t).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(t).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(t).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessRange!==void 0&&(n.iridescenceThicknessRange=this.iridescenceThicknessRange),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(t).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(t).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(t).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(t).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(t).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(t).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(t).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(t).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(t).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(t).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(t).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(t).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(t).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(t).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(t).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(t).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(t).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(t).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(t).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(t).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(t).uuid),this.attenuationDistance!==void 0&&this.attenuationDistance!==1/0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.shadowSide!==null&&(n.shadowSide=this.shadowSide),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),this.blending!==Gr&&(n.blending=this.blending),this.side!==Ls&&(n.side=this.side),this.vertexColors===!0&&(n.vertexColors=!0),this.opacity<1&&(n.opacity=this.opacity),this.transparent===!0&&(n.transparent=!0),this.blendSrc!==Rh&&(n.blendSrc=this.blendSrc),this.blendDst!==Ph&&(n.blendDst=this.blendDst),this.blendEquation!==Ks&&(n.blendEquation=this.blendEquation),this.blendSrcAlpha!==null&&(n.blendSrcAlpha=this.blendSrcAlpha),this.blendDstAlpha!==null&&(n.blendDstAlpha=this.blendDstAlpha),this.blendEquationAlpha!==null&&(n.blendEquationAlpha=this.blendEquationAlpha),this.blendColor&&this.blendColor.isColor&&(n.blendColor=this.blendColor.getHex()),this.blendAlpha!==0&&(n.blendAlpha=this.blendAlpha),this.depthFunc!==$r&&(n.depthFunc=this.depthFunc),this.depthTest===!1&&(n.depthTest=this.depthTest),this.depthWrite===!1&&(n.depthWrite=this.depthWrite),this.colorWrite===!1&&(n.colorWrite=this.colorWrite),this.stencilWriteMask!==255&&(n.stencilWriteMask=this.stencilWriteMask),this.stencilFunc!==$d&&(n.stencilFunc=this.stencilFunc),this.stencilRef!==0&&(n.stencilRef=this.stencilRef),this.stencilFuncMask!==255&&(n.stencilFuncMask=this.stencilFuncMask),this.stencilFail!==Ar&&(n.stencilFail=this.stencilFail),this.stencilZFail!==Ar&&(n.stencilZFail=this.stencilZFail),this.stencilZPass!==Ar&&(n.stencilZPass=this.stencilZPass),this.stencilWrite===!0&&(n.stencilWrite=this.stencilWrite),this.rotation!==void 0&&this.rotation!==0&&(n.rotation=this.rotation),this.polygonOffset===!0&&(n.polygonOffset=!0),this.polygonOffsetFactor!==0&&(n.polygonOffsetFactor=this.polygonOffsetFactor),this.polygonOffsetUnits!==0&&(n.polygonOffsetUnits=this.polygonOffsetUnits),this.linewidth!==void 0&&this.linewidth!==1&&(n.linewidth=this.linewidth),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.dithering===!0&&(n.dithering=!0),this.alphaTest>0&&(n.alphaTest=this.alphaTest),this.alphaHash===!0&&(n.alphaHash=!0),this.alphaToCoverage===!0&&(n.alphaToCoverage=!0),this.premultipliedAlpha===!0&&(n.premultipliedAlpha=!0),this.forceSinglePass===!0&&(n.forceSinglePass=!0),this.wireframe===!0&&(n.wireframe=!0),this.wireframeLinewidth>1&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!=="round"&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!=="round"&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading===!0&&(n.flatShading=!0),this.visible===!1&&(n.visible=!1),this.toneMapped===!1&&(n.toneMapped=!1),this.fog===!1&&(n.fog=!1),Object.keys(this.userData).length>0&&(n.userData=this.userData);function s(r){let o=[];for(let a in r){let l=r[a];delete l.metadata,o.push(l)}return o}if(e){let r=s(t.textures),o=s(t.images);r.length>0&&(n.textures=r),o.length>0&&(n.images=o)}return n}clone(){return new this.constructor().copy(this)}copy(t){this.name=t.name,this.blending=t.blending,this.side=t.side,this.vertexColors=t.vertexColors,this.opacity=t.opacity,this.transparent=t.transparent,this.blendSrc=t.blendSrc,this.blendDst=t.blendDst,this.blendEquation=t.blendEquation,this.blendSrcAlpha=t.blendSrcAlpha,this.blendDstAlpha=t.blendDstAlpha,this.blendEquationAlpha=t.blendEquationAlpha,this.blendColor.copy(t.blendColor),this.blendAlpha=t.blendAlpha,this.depthFunc=t.depthFunc,this.depthTest=t.depthTest,this.depthWrite=t.depthWrite,this.stencilWriteMask=t.stencilWriteMask,this.stencilFunc=t.stencilFunc,this.stencilRef=t.stencilRef,this.stencilFuncMask=t.stencilFuncMask,this.stencilFail=t.stencilFail,this.stencilZFail=t.stencilZFail,this.stencilZPass=t.stencilZPass,this.stencilWrite=t.stencilWrite;let e=t.clippingPlanes,n=null;if(e!==null){let s=e.length;n=new Array(s);for(let r=0;r!==s;++r)n[r]=e[r].clone()}return this.clippingPlanes=n,this.clipIntersection=t.clipIntersection,this.clipShadows=t.clipShadows,this.shadowSide=t.shadowSide,this.colorWrite=t.colorWrite,this.precision=t.precision,this.polygonOffset=t.polygonOffset,this.polygonOffsetFactor=t.polygonOffsetFactor,this.polygonOffsetUnits=t.polygonOffsetUnits,this.dithering=t.dithering,this.alphaTest=t.alphaTest,this.alphaHash=t.alphaHash,this.alphaToCoverage=t.alphaToCoverage,this.premultipliedAlpha=t.premultipliedAlpha,this.forceSinglePass=t.forceSinglePass,this.visible=t.visible,this.toneMapped=t.toneMapped,this.userData=JSON.parse(JSON.stringify(t.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(t){t===!0&&this.version++}onBuild(){console.warn("Material: onBuild() has been removed.")}},us=class extends Ds{static get type(){return"MeshBasicMaterial"}constructor(t){super(),this.isMeshBasicMaterial=!0,this.color=new oe(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ki,this.combine=sf,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.fog=t.fog,this}};var tn=new D,Pa=new gt,$n=class{constructor(t,e,n=!1){if(Array.isArray(t))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,this.name="",this.array=t,this.itemSize=e,this.count=t!==void 0?t.length/e:0,this.normalized=n,this.usage=mu,this.updateRanges=[],this.gpuType=rs,this.version=0}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.name=t.name,this.array=new t.array.constructor(t.array),this.itemSize=t.itemSize,this.count=t.count,this.normalized=t.normalized,this.usage=t.usage,this.gpuType=t.gpuType,this}copyAt(t,e,n){t*=this.itemSize,n*=e.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[t+s]=e.array[n+s];return this}copyArray(t){return this.array.set(t),this}applyMatrix3(t){if(this.itemSize===2)for(let e=0,n=this.count;e<n;e++)Pa.fromBufferAttribute(this,e),Pa.applyMatrix3(t),this.setXY(e,Pa.x,Pa.y);else if(this.itemSize===3)for(let e=0,n=this.count;e<n;e++)tn.fromBufferAttribute(this,e),tn.applyMatrix3(t),this.setXYZ(e,tn.x,tn.y,tn.z);return this}applyMatrix4(t){for(let e=0,n=this.count;e<n;e++)tn.fromBufferAttribute(this,e),tn.applyMatrix4(t),this.setXYZ(e,tn.x,tn.y,tn.z);return this}applyNormalMatrix(t){for(let e=0,n=this.count;e<n;e++)tn.fromBufferAttribute(this,e),tn.applyNormalMatrix(t),this.setXYZ(e,tn.x,tn.y,tn.z);return this}transformDirection(t){for(let e=0,n=this.count;e<n;e++)tn.fromBufferAttribute(this,e),tn.transformDirection(t),this.setXYZ(e,tn.x,tn.y,tn.z);return this}set(t,e=0){return this.array.set(t,e),this}getComponent(t,e){let n=this.array[t*this.itemSize+e];return this.normalized&&(n=vi(n,this.array)),n}setComponent(t,e,n){return this.normalized&&(n=Re(n,this.array)),this.array[t*this.itemSize+e]=n,this}getX(t){let e=this.array[t*this.itemSize];return this.normalized&&(e=vi(e,this.array)),e}setX(t,e){return this.normalized&&(e=Re(e,this.array)),this.array[t*this.itemSize]=e,this}getY(t){let e=this.array[t*this.itemSize+1];return this.normalized&&(e=vi(e,this.array)),e}setY(t,e){return this.normalized&&(e=Re(e,this.array)),this.array[t*this.itemSize+1]=e,this}getZ(t){let e=this.array[t*this.itemSize+2];return this.normalized&&(e=vi(e,this.array)),e}setZ(t,e){return this.normalized&&(e=Re(e,this.array)),this.array[t*this.itemSize+2]=e,this}getW(t){let e=this.array[t*this.itemSize+3];return this.normalized&&(e=vi(e,this.array)),e}setW(t,e){return this.normalized&&(e=Re(e,this.array)),this.array[t*this.itemSize+3]=e,this}setXY(t,e,n){return t*=this.itemSize,this.normalized&&(e=Re(e,this.array),n=Re(n,this.array)),this.array[t+0]=e,this.array[t+1]=n,this}setXYZ(t,e,n,s){return t*=this.itemSize,this.normalized&&(e=Re(e,this.array),n=Re(n,this.array),s=Re(s,this.array)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this}setXYZW(t,e,n,s,r){return t*=this.itemSize,this.normalized&&(e=Re(e,this.array),n=Re(n,this.array),s=Re(s,this.array),r=Re(r,this.array)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this.array[t+3]=r,this}onUpload(t){return this.onUploadCallback=t,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let t={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return this.name!==""&&(t.name=this.name),this.usage!==mu&&(t.usage=this.usage),t}};var ll=class extends $n{constructor(t,e,n){super(new Uint16Array(t),e,n)}};var cl=class extends $n{constructor(t,e,n){super(new Uint32Array(t),e,n)}};var Qt=class extends $n{constructor(t,e,n){super(new Float32Array(t),e,n)}},qx=0,si=new ze,ph=new En,Or=new D,qn=new Vn,Po=new Vn,gn=new D,ve=class i extends cs{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:qx++}),this.uuid=Bi(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={}}getIndex(){return this.index}setIndex(t){return Array.isArray(t)?this.index=new(_m(t)?cl:ll)(t,1):this.index=t,this}setIndirect(t){return this.indirect=t,this}getIndirect(){return this.indirect}getAttribute(t){return this.attributes[t]}setAttribute(t,e){return this.attributes[t]=e,this}deleteAttribute(t){return delete this.attributes[t],this}hasAttribute(t){return this.attributes[t]!==void 0}addGroup(t,e,n=0){this.groups.push({start:t,count:e,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(t,e){this.drawRange.start=t,this.drawRange.count=e}applyMatrix4(t){let e=this.attributes.position;e!==void 0&&(e.applyMatrix4(t),e.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let r=new le().getNormalMatrix(t);n.applyNormalMatrix(r),n.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(t),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this}applyQuaternion(t){return si.makeRotationFromQuaternion(t),this.applyMatrix4(si),this}rotateX(t){return si.makeRotationX(t),this.applyMatrix4(si),this}rotateY(t){return si.makeRotationY(t),this.applyMatrix4(si),this}rotateZ(t){return si.makeRotationZ(t),this.applyMatrix4(si),this}translate(t,e,n){return si.makeTranslation(t,e,n),this.applyMatrix4(si),this}scale(t,e,n){return si.makeScale(t,e,n),this.applyMatrix4(si),this}lookAt(t){return ph.lookAt(t),ph.updateMatrix(),this.applyMatrix4(ph.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(Or).negate(),this.translate(Or.x,Or.y,Or.z),this}setFromPoints(t){let e=this.getAttribute("position");if(e===void 0){let n=[];for(let s=0,r=t.length;s<r;s++){let o=t[s];n.push(o.x,o.y,o.z||0)}this.setAttribute("position",new Qt(n,3))}else{for(let n=0,s=e.count;n<s;n++){let r=t[n];e.setXYZ(n,r.x,r.y,r.z||0)}t.length>e.count&&console.warn("THREE.BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),e.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new Vn);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){console.error("THREE.BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new D(-1/0,-1/0,-1/0),new D(1/0,1/0,1/0));return}if(t!==void 0){if(this.boundingBox.setFromBufferAttribute(t),e)for(let n=0,s=e.length;n<s;n++){let r=e[n];qn.setFromBufferAttribute(r),this.morphTargetsRelative?(gn.addVectors(this.boundingBox.min,qn.min),this.boundingBox.expandByPoint(gn),gn.addVectors(this.boundingBox.max,qn.max),this.boundingBox.expandByPoint(gn)):(this.boundingBox.expandByPoint(qn.min),this.boundingBox.expandByPoint(qn.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&console.error('THREE.BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new zi);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){console.error("THREE.BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new D,1/0);return}if(t){let n=this.boundingSphere.center;if(qn.setFromBufferAttribute(t),e)for(let r=0,o=e.length;r<o;r++){let a=e[r];Po.setFromBufferAttribute(a),this.morphTargetsRelative?(gn.addVectors(qn.min,Po.min),qn.expandByPoint(gn),gn.addVectors(qn.max,Po.max),qn.expandByPoint(gn)):(qn.expandByPoint(Po.min),qn.expandByPoint(Po.max))}qn.getCenter(n);let s=0;for(let r=0,o=t.count;r<o;r++)gn.fromBufferAttribute(t,r),s=Math.max(s,n.distanceToSquared(gn));if(e)for(let r=0,o=e.length;r<o;r++){let a=e[r],l=this.morphTargetsRelative;for(let c=0,h=a.count;c<h;c++)gn.fromBufferAttribute(a,c),l&&(Or.fromBufferAttribute(t,c),gn.add(Or)),s=Math.max(s,n.distanceToSquared(gn))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&console.error('THREE.BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let t=this.index,e=this.attributes;if(t===null||e.position===void 0||e.normal===void 0||e.uv===void 0){console.error("THREE.BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let n=e.position,s=e.normal,r=e.uv;this.hasAttribute("tangent")===!1&&this.setAttribute("tangent",new $n(new Float32Array(4*n.count),4));let o=this.getAttribute("tangent"),a=[],l=[];for(let F=0;F<n.count;F++)a[F]=new D,l[F]=new D;let c=new D,h=new D,f=new D,u=new gt,d=new gt,m=new gt,_=new D,g=new D;function p(F,E,M){c.fromBufferAttribute(n,F),h.fromBufferAttribute(n,E),f.fromBufferAttribute(n,M),u.fromBufferAttribute(r,F),d.fromBufferAttribute(r,E),m.fromBufferAttribute(r,M),h.sub(c),f.sub(c),d.sub(u),m.sub(u);let A=1/(d.x*m.y-m.x*d.y);isFinite(A)&&(_.copy(h).multiplyScalar(m.y).addScaledVector(f,-d.y).multiplyScalar(A),g.copy(f).multiplyScalar(d.x).addScaledVector(h,-m.x).multiplyScalar(A),a[F].add(_),a[E].add(_),a[M].add(_),l[F].add(g),l[E].add(g),l[M].add(g))}let S=this.groups;S.length===0&&(S=[{start:0,count:t.count}]);for(let F=0,E=S.length;F<E;++F){let M=S[F],A=M.start,W=M.count;for(let G=A,X=A+W;G<X;G+=3)p(t.getX(G+0),t.getX(G+1),t.getX(G+2))}let v=new D,y=new D,U=new D,R=new D;function P(F){U.fromBufferAttribute(s,F),R.copy(U);let E=a[F];v.copy(E),v.sub(U.multiplyScalar(U.dot(E))).normalize(),y.crossVectors(R,E);let A=y.dot(l[F])<0?-1:1;o.setXYZW(F,v.x,v.y,v.z,A)}for(let F=0,E=S.length;F<E;++F){let M=S[F],A=M.start,W=M.count;for(let G=A,X=A+W;G<X;G+=3)P(t.getX(G+0)),P(t.getX(G+1)),P(t.getX(G+2))}}computeVertexNormals(){let t=this.index,e=this.getAttribute("position");if(e!==void 0){let n=this.getAttribute("normal");if(n===void 0)n=new $n(new Float32Array(e.count*3),3),this.setAttribute("normal",n);else for(let u=0,d=n.count;u<d;u++)n.setXYZ(u,0,0,0);let s=new D,r=new D,o=new D,a=new D,l=new D,c=new D,h=new D,f=new D;if(t)for(let u=0,d=t.count;u<d;u+=3){let m=t.getX(u+0),_=t.getX(u+1),g=t.getX(u+2);s.fromBufferAttribute(e,m),r.fromBufferAttribute(e,_),o.fromBufferAttribute(e,g),h.subVectors(o,r),f.subVectors(s,r),h.cross(f),a.fromBufferAttribute(n,m),l.fromBufferAttribute(n,_),c.fromBufferAttribute(n,g),a.add(h),l.add(h),c.add(h),n.setXYZ(m,a.x,a.y,a.z),n.setXYZ(_,l.x,l.y,l.z),n.setXYZ(g,c.x,c.y,c.z)}else for(let u=0,d=e.count;u<d;u+=3)s.fromBufferAttribute(e,u+0),r.fromBufferAttribute(e,u+1),o.fromBufferAttribute(e,u+2),h.subVectors(o,r),f.subVectors(s,r),h.cross(f),n.setXYZ(u+0,h.x,h.y,h.z),n.setXYZ(u+1,h.x,h.y,h.z),n.setXYZ(u+2,h.x,h.y,h.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let t=this.attributes.normal;for(let e=0,n=t.count;e<n;e++)gn.fromBufferAttribute(t,e),gn.normalize(),t.setXYZ(e,gn.x,gn.y,gn.z)}toNonIndexed(){function t(a,l){let c=a.array,h=a.itemSize,f=a.normalized,u=new c.constructor(l.length*h),d=0,m=0;for(let _=0,g=l.length;_<g;_++){a.isInterleavedBufferAttribute?d=l[_]*a.data.stride+a.offset:d=l[_]*h;for(let p=0;p<h;p++)u[m++]=c[d++]}return new $n(u,h,f)}if(this.index===null)return console.warn("THREE.BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let e=new i,n=this.index.array,s=this.attributes;for(let a in s){let l=s[a],c=t(l,n);e.setAttribute(a,c)}let r=this.morphAttributes;for(let a in r){let l=[],c=r[a];for(let h=0,f=c.length;h<f;h++){let u=c[h],d=t(u,n);l.push(d)}e.morphAttributes[a]=l}e.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,l=o.length;a<l;a++){let c=o[a];e.addGroup(c.start,c.count,c.materialIndex)}return e}toJSON(){let t={metadata:{version:4.6,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(t.uuid=this.uuid,t.type=this.type,this.name!==""&&(t.name=this.name),Object.keys(this.userData).length>0&&(t.userData=this.userData),this.parameters!==void 0){let l=this.parameters;for(let c in l)l[c]!==void 0&&(t[c]=l[c]);return t}t.data={attributes:{}};let e=this.index;e!==null&&(t.data.index={type:e.array.constructor.name,array:Array.prototype.slice.call(e.array)});let n=this.attributes;for(let l in n){let c=n[l];t.data.attributes[l]=c.toJSON(t.data)}let s={},r=!1;for(let l in this.morphAttributes){let c=this.morphAttributes[l],h=[];for(let f=0,u=c.length;f<u;f++){let d=c[f];h.push(d.toJSON(t.data))}h.length>0&&(s[l]=h,r=!0)}r&&(t.data.morphAttributes=s,t.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(t.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(t.data.boundingSphere={center:a.center.toArray(),radius:a.radius}),t}clone(){return new this.constructor().copy(this)}copy(t){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let e={};this.name=t.name;let n=t.index;n!==null&&this.setIndex(n.clone(e));let s=t.attributes;for(let c in s){let h=s[c];this.setAttribute(c,h.clone(e))}let r=t.morphAttributes;for(let c in r){let h=[],f=r[c];for(let u=0,d=f.length;u<d;u++)h.push(f[u].clone(e));this.morphAttributes[c]=h}this.morphTargetsRelative=t.morphTargetsRelative;let o=t.groups;for(let c=0,h=o.length;c<h;c++){let f=o[c];this.addGroup(f.start,f.count,f.materialIndex)}let a=t.boundingBox;a!==null&&(this.boundingBox=a.clone());let l=t.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=t.drawRange.start,this.drawRange.count=t.drawRange.count,this.userData=t.userData,this}dispose(){this.dispatchEvent({type:"dispose"})}},fp=new ze,qs=new nr,Ia=new zi,dp=new D,La=new D,Da=new D,Ua=new D,mh=new D,Na=new D,pp=new D,Fa=new D,xe=class extends En{constructor(t=new ve,e=new us){super(),this.isMesh=!0,this.type="Mesh",this.geometry=t,this.material=e,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0&&(this.morphTargetInfluences=t.morphTargetInfluences.slice()),t.morphTargetDictionary!==void 0&&(this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary)),this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(t,e){let n=this.geometry,s=n.attributes.position,r=n.morphAttributes.position,o=n.morphTargetsRelative;e.fromBufferAttribute(s,t);let a=this.morphTargetInfluences;if(r&&a){Na.set(0,0,0);for(let l=0,c=r.length;l<c;l++){let h=a[l],f=r[l];h!==0&&(mh.fromBufferAttribute(f,t),o?Na.addScaledVector(mh,h):Na.addScaledVector(mh.sub(e),h))}e.add(Na)}return e}raycast(t,e){let n=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),Ia.copy(n.boundingSphere),Ia.applyMatrix4(r),qs.copy(t.ray).recast(t.near),!(Ia.containsPoint(qs.origin)===!1&&(qs.intersectSphere(Ia,dp)===null||qs.origin.distanceToSquared(dp)>(t.far-t.near)**2))&&(fp.copy(r).invert(),qs.copy(t.ray).applyMatrix4(fp),!(n.boundingBox!==null&&qs.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(t,e,qs)))}_computeIntersections(t,e,n){let s,r=this.geometry,o=this.material,a=r.index,l=r.attributes.position,c=r.attributes.uv,h=r.attributes.uv1,f=r.attributes.normal,u=r.groups,d=r.drawRange;if(a!==null)if(Array.isArray(o))for(let m=0,_=u.length;m<_;m++){let g=u[m],p=o[g.materialIndex],S=Math.max(g.start,d.start),v=Math.min(a.count,Math.min(g.start+g.count,d.start+d.count));for(let y=S,U=v;y<U;y+=3){let R=a.getX(y),P=a.getX(y+1),F=a.getX(y+2);s=Oa(this,p,t,n,c,h,f,R,P,F),s&&(s.faceIndex=Math.floor(y/3),s.face.materialIndex=g.materialIndex,e.push(s))}}else{let m=Math.max(0,d.start),_=Math.min(a.count,d.start+d.count);for(let g=m,p=_;g<p;g+=3){let S=a.getX(g),v=a.getX(g+1),y=a.getX(g+2);s=Oa(this,o,t,n,c,h,f,S,v,y),s&&(s.faceIndex=Math.floor(g/3),e.push(s))}}else if(l!==void 0)if(Array.isArray(o))for(let m=0,_=u.length;m<_;m++){let g=u[m],p=o[g.materialIndex],S=Math.max(g.start,d.start),v=Math.min(l.count,Math.min(g.start+g.count,d.start+d.count));for(let y=S,U=v;y<U;y+=3){let R=y,P=y+1,F=y+2;s=Oa(this,p,t,n,c,h,f,R,P,F),s&&(s.faceIndex=Math.floor(y/3),s.face.materialIndex=g.materialIndex,e.push(s))}}else{let m=Math.max(0,d.start),_=Math.min(l.count,d.start+d.count);for(let g=m,p=_;g<p;g+=3){let S=g,v=g+1,y=g+2;s=Oa(this,o,t,n,c,h,f,S,v,y),s&&(s.faceIndex=Math.floor(g/3),e.push(s))}}}};function Yx(i,t,e,n,s,r,o,a){let l;if(t.side===zn?l=n.intersectTriangle(o,r,s,!0,a):l=n.intersectTriangle(s,r,o,t.side===Ls,a),l===null)return null;Fa.copy(a),Fa.applyMatrix4(i.matrixWorld);let c=e.ray.origin.distanceTo(Fa);return c<e.near||c>e.far?null:{distance:c,point:Fa.clone(),object:i}}function Oa(i,t,e,n,s,r,o,a,l,c){i.getVertexPosition(a,La),i.getVertexPosition(l,Da),i.getVertexPosition(c,Ua);let h=Yx(i,t,e,n,La,Da,Ua,pp);if(h){let f=new D;Fi.getBarycoord(pp,La,Da,Ua,f),s&&(h.uv=Fi.getInterpolatedAttribute(s,a,l,c,f,new gt)),r&&(h.uv1=Fi.getInterpolatedAttribute(r,a,l,c,f,new gt)),o&&(h.normal=Fi.getInterpolatedAttribute(o,a,l,c,f,new D),h.normal.dot(n.direction)>0&&h.normal.multiplyScalar(-1));let u={a,b:l,c,normal:new D,materialIndex:0};Fi.getNormal(La,Da,Ua,u.normal),h.face=u,h.barycoord=f}return h}var Vi=class i extends ve{constructor(t=1,e=1,n=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:t,height:e,depth:n,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let l=[],c=[],h=[],f=[],u=0,d=0;m("z","y","x",-1,-1,n,e,t,o,r,0),m("z","y","x",1,-1,n,e,-t,o,r,1),m("x","z","y",1,1,t,n,e,s,o,2),m("x","z","y",1,-1,t,n,-e,s,o,3),m("x","y","z",1,-1,t,e,n,s,r,4),m("x","y","z",-1,-1,t,e,-n,s,r,5),this.setIndex(l),this.setAttribute("position",new Qt(c,3)),this.setAttribute("normal",new Qt(h,3)),this.setAttribute("uv",new Qt(f,2));function m(_,g,p,S,v,y,U,R,P,F,E){let M=y/P,A=U/F,W=y/2,G=U/2,X=R/2,Z=P+1,Y=F+1,nt=0,Q=0,dt=new D;for(let at=0;at<Y;at++){let _t=at*A-G;for(let pt=0;pt<Z;pt++){let Zt=pt*M-W;dt[_]=Zt*S,dt[g]=_t*v,dt[p]=X,c.push(dt.x,dt.y,dt.z),dt[_]=0,dt[g]=0,dt[p]=R>0?1:-1,h.push(dt.x,dt.y,dt.z),f.push(pt/P),f.push(1-at/F),nt+=1}}for(let at=0;at<F;at++)for(let _t=0;_t<P;_t++){let pt=u+_t+Z*at,Zt=u+_t+Z*(at+1),J=u+(_t+1)+Z*(at+1),ht=u+(_t+1)+Z*at;l.push(pt,Zt,ht),l.push(Zt,J,ht),Q+=6}a.addGroup(d,Q,E),d+=Q,u+=nt}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.depth,t.widthSegments,t.heightSegments,t.depthSegments)}};function Qr(i){let t={};for(let e in i){t[e]={};for(let n in i[e]){let s=i[e][n];s&&(s.isColor||s.isMatrix3||s.isMatrix4||s.isVector2||s.isVector3||s.isVector4||s.isTexture||s.isQuaternion)?s.isRenderTargetTexture?(console.warn("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),t[e][n]=null):t[e][n]=s.clone():Array.isArray(s)?t[e][n]=s.slice():t[e][n]=s}}return t}function Dn(i){let t={};for(let e=0;e<i.length;e++){let n=Qr(i[e]);for(let s in n)t[s]=n[s]}return t}function $x(i){let t=[];for(let e=0;e<i.length;e++)t.push(i[e].clone());return t}function ym(i){let t=i.getRenderTarget();return t===null?i.outputColorSpace:t.isXRRenderTarget===!0?t.texture.colorSpace:be.workingColorSpace}var Hl={clone:Qr,merge:Dn},Zx=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,Jx=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,ai=class extends Ds{static get type(){return"ShaderMaterial"}constructor(t){super(),this.isShaderMaterial=!0,this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=Zx,this.fragmentShader=Jx,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,t!==void 0&&this.setValues(t)}copy(t){return super.copy(t),this.fragmentShader=t.fragmentShader,this.vertexShader=t.vertexShader,this.uniforms=Qr(t.uniforms),this.uniformsGroups=$x(t.uniformsGroups),this.defines=Object.assign({},t.defines),this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.fog=t.fog,this.lights=t.lights,this.clipping=t.clipping,this.extensions=Object.assign({},t.extensions),this.glslVersion=t.glslVersion,this}toJSON(t){let e=super.toJSON(t);e.glslVersion=this.glslVersion,e.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?e.uniforms[s]={type:"t",value:o.toJSON(t).uuid}:o&&o.isColor?e.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?e.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?e.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?e.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?e.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?e.uniforms[s]={type:"m4",value:o.toArray()}:e.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(e.defines=this.defines),e.vertexShader=this.vertexShader,e.fragmentShader=this.fragmentShader,e.lights=this.lights,e.clipping=this.clipping;let n={};for(let s in this.extensions)this.extensions[s]===!0&&(n[s]=!0);return Object.keys(n).length>0&&(e.extensions=n),e}},hl=class extends En{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new ze,this.projectionMatrix=new ze,this.projectionMatrixInverse=new ze,this.coordinateSystem=os}copy(t,e){return super.copy(t,e),this.matrixWorldInverse.copy(t.matrixWorldInverse),this.projectionMatrix.copy(t.projectionMatrix),this.projectionMatrixInverse.copy(t.projectionMatrixInverse),this.coordinateSystem=t.coordinateSystem,this}getWorldDirection(t){return super.getWorldDirection(t).negate()}updateMatrixWorld(t){super.updateMatrixWorld(t),this.matrixWorldInverse.copy(this.matrixWorld).invert()}updateWorldMatrix(t,e){super.updateWorldMatrix(t,e),this.matrixWorldInverse.copy(this.matrixWorld).invert()}clone(){return new this.constructor().copy(this)}},As=new D,mp=new gt,gp=new gt,Un=class extends hl{constructor(t=50,e=1,n=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=t,this.zoom=1,this.near=n,this.far=s,this.focus=10,this.aspect=e,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.fov=t.fov,this.zoom=t.zoom,this.near=t.near,this.far=t.far,this.focus=t.focus,this.aspect=t.aspect,this.view=t.view===null?null:Object.assign({},t.view),this.filmGauge=t.filmGauge,this.filmOffset=t.filmOffset,this}setFocalLength(t){let e=.5*this.getFilmHeight()/t;this.fov=zo*2*Math.atan(e),this.updateProjectionMatrix()}getFocalLength(){let t=Math.tan(Xr*.5*this.fov);return .5*this.getFilmHeight()/t}getEffectiveFOV(){return zo*2*Math.atan(Math.tan(Xr*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(t,e,n){As.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),e.set(As.x,As.y).multiplyScalar(-t/As.z),As.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(As.x,As.y).multiplyScalar(-t/As.z)}getViewSize(t,e){return this.getViewBounds(t,mp,gp),e.subVectors(gp,mp)}setViewOffset(t,e,n,s,r,o){this.aspect=t/e,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=this.near,e=t*Math.tan(Xr*.5*this.fov)/this.zoom,n=2*e,s=this.aspect*n,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let l=o.fullWidth,c=o.fullHeight;r+=o.offsetX*s/l,e-=o.offsetY*n/c,s*=o.width/l,n*=o.height/c}let a=this.filmOffset;a!==0&&(r+=t*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,e,e-n,t,this.far,this.coordinateSystem),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.fov=this.fov,e.object.zoom=this.zoom,e.object.near=this.near,e.object.far=this.far,e.object.focus=this.focus,e.object.aspect=this.aspect,this.view!==null&&(e.object.view=Object.assign({},this.view)),e.object.filmGauge=this.filmGauge,e.object.filmOffset=this.filmOffset,e}},Br=-90,zr=1,yu=class extends En{constructor(t,e,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new Un(Br,zr,t,e);s.layers=this.layers,this.add(s);let r=new Un(Br,zr,t,e);r.layers=this.layers,this.add(r);let o=new Un(Br,zr,t,e);o.layers=this.layers,this.add(o);let a=new Un(Br,zr,t,e);a.layers=this.layers,this.add(a);let l=new Un(Br,zr,t,e);l.layers=this.layers,this.add(l);let c=new Un(Br,zr,t,e);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let t=this.coordinateSystem,e=this.children.concat(),[n,s,r,o,a,l]=e;for(let c of e)this.remove(c);if(t===os)n.up.set(0,1,0),n.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(t===sl)n.up.set(0,-1,0),n.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+t);for(let c of e)this.add(c),c.updateMatrixWorld()}update(t,e){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:s}=this;this.coordinateSystem!==t.coordinateSystem&&(this.coordinateSystem=t.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,l,c,h]=this.children,f=t.getRenderTarget(),u=t.getActiveCubeFace(),d=t.getActiveMipmapLevel(),m=t.xr.enabled;t.xr.enabled=!1;let _=n.texture.generateMipmaps;n.texture.generateMipmaps=!1,t.setRenderTarget(n,0,s),t.render(e,r),t.setRenderTarget(n,1,s),t.render(e,o),t.setRenderTarget(n,2,s),t.render(e,a),t.setRenderTarget(n,3,s),t.render(e,l),t.setRenderTarget(n,4,s),t.render(e,c),n.texture.generateMipmaps=_,t.setRenderTarget(n,5,s),t.render(e,h),t.setRenderTarget(f,u,d),t.xr.enabled=m,n.texture.needsPMREMUpdate=!0}},ul=class extends oi{constructor(t,e,n,s,r,o,a,l,c,h){t=t!==void 0?t:[],e=e!==void 0?e:Zr,super(t,e,n,s,r,o,a,l,c,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(t){this.image=t}},vu=class extends hs{constructor(t=1,e={}){super(t,t,e),this.isWebGLCubeRenderTarget=!0;let n={width:t,height:t,depth:1},s=[n,n,n,n,n,n];this.texture=new ul(s,e.mapping,e.wrapS,e.wrapT,e.magFilter,e.minFilter,e.format,e.type,e.anisotropy,e.colorSpace),this.texture.isRenderTargetTexture=!0,this.texture.generateMipmaps=e.generateMipmaps!==void 0?e.generateMipmaps:!1,this.texture.minFilter=e.minFilter!==void 0?e.minFilter:Oi}fromEquirectangularTexture(t,e){this.texture.type=e.type,this.texture.colorSpace=e.colorSpace,this.texture.generateMipmaps=e.generateMipmaps,this.texture.minFilter=e.minFilter,this.texture.magFilter=e.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},s=new Vi(5,5,5),r=new ai({name:"CubemapFromEquirect",uniforms:Qr(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:zn,blending:Rs});r.uniforms.tEquirect.value=e;let o=new xe(s,r),a=e.minFilter;return e.minFilter===tr&&(e.minFilter=Oi),new yu(1,10,this).update(t,o),e.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(t,e,n,s){let r=t.getRenderTarget();for(let o=0;o<6;o++)t.setRenderTarget(this,o),t.clear(e,n,s);t.setRenderTarget(r)}},gh=new D,Kx=new D,jx=new le,Yn=class{constructor(t=new D(1,0,0),e=0){this.isPlane=!0,this.normal=t,this.constant=e}set(t,e){return this.normal.copy(t),this.constant=e,this}setComponents(t,e,n,s){return this.normal.set(t,e,n),this.constant=s,this}setFromNormalAndCoplanarPoint(t,e){return this.normal.copy(t),this.constant=-e.dot(this.normal),this}setFromCoplanarPoints(t,e,n){let s=gh.subVectors(n,e).cross(Kx.subVectors(t,e)).normalize();return this.setFromNormalAndCoplanarPoint(s,t),this}copy(t){return this.normal.copy(t.normal),this.constant=t.constant,this}normalize(){let t=1/this.normal.length();return this.normal.multiplyScalar(t),this.constant*=t,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(t){return this.normal.dot(t)+this.constant}distanceToSphere(t){return this.distanceToPoint(t.center)-t.radius}projectPoint(t,e){return e.copy(t).addScaledVector(this.normal,-this.distanceToPoint(t))}intersectLine(t,e){let n=t.delta(gh),s=this.normal.dot(n);if(s===0)return this.distanceToPoint(t.start)===0?e.copy(t.start):null;let r=-(t.start.dot(this.normal)+this.constant)/s;return r<0||r>1?null:e.copy(t.start).addScaledVector(n,r)}intersectsLine(t){let e=this.distanceToPoint(t.start),n=this.distanceToPoint(t.end);return e<0&&n>0||n<0&&e>0}intersectsBox(t){return t.intersectsPlane(this)}intersectsSphere(t){return t.intersectsPlane(this)}coplanarPoint(t){return t.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(t,e){let n=e||jx.getNormalMatrix(t),s=this.coplanarPoint(gh).applyMatrix4(t),r=this.normal.applyMatrix3(n).normalize();return this.constant=-s.dot(r),this}translate(t){return this.constant-=t.dot(this.normal),this}equals(t){return t.normal.equals(this.normal)&&t.constant===this.constant}clone(){return new this.constructor().copy(this)}},Ys=new zi,Ba=new D,Vo=class{constructor(t=new Yn,e=new Yn,n=new Yn,s=new Yn,r=new Yn,o=new Yn){this.planes=[t,e,n,s,r,o]}set(t,e,n,s,r,o){let a=this.planes;return a[0].copy(t),a[1].copy(e),a[2].copy(n),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(t){let e=this.planes;for(let n=0;n<6;n++)e[n].copy(t.planes[n]);return this}setFromProjectionMatrix(t,e=os){let n=this.planes,s=t.elements,r=s[0],o=s[1],a=s[2],l=s[3],c=s[4],h=s[5],f=s[6],u=s[7],d=s[8],m=s[9],_=s[10],g=s[11],p=s[12],S=s[13],v=s[14],y=s[15];if(n[0].setComponents(l-r,u-c,g-d,y-p).normalize(),n[1].setComponents(l+r,u+c,g+d,y+p).normalize(),n[2].setComponents(l+o,u+h,g+m,y+S).normalize(),n[3].setComponents(l-o,u-h,g-m,y-S).normalize(),n[4].setComponents(l-a,u-f,g-_,y-v).normalize(),e===os)n[5].setComponents(l+a,u+f,g+_,y+v).normalize();else if(e===sl)n[5].setComponents(a,f,_,v).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+e);return this}intersectsObject(t){if(t.boundingSphere!==void 0)t.boundingSphere===null&&t.computeBoundingSphere(),Ys.copy(t.boundingSphere).applyMatrix4(t.matrixWorld);else{let e=t.geometry;e.boundingSphere===null&&e.computeBoundingSphere(),Ys.copy(e.boundingSphere).applyMatrix4(t.matrixWorld)}return this.intersectsSphere(Ys)}intersectsSprite(t){return Ys.center.set(0,0,0),Ys.radius=.7071067811865476,Ys.applyMatrix4(t.matrixWorld),this.intersectsSphere(Ys)}intersectsSphere(t){let e=this.planes,n=t.center,s=-t.radius;for(let r=0;r<6;r++)if(e[r].distanceToPoint(n)<s)return!1;return!0}intersectsBox(t){let e=this.planes;for(let n=0;n<6;n++){let s=e[n];if(Ba.x=s.normal.x>0?t.max.x:t.min.x,Ba.y=s.normal.y>0?t.max.y:t.min.y,Ba.z=s.normal.z>0?t.max.z:t.min.z,s.distanceToPoint(Ba)<0)return!1}return!0}containsPoint(t){let e=this.planes;for(let n=0;n<6;n++)if(e[n].distanceToPoint(t)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}};function vm(){let i=null,t=!1,e=null,n=null;function s(r,o){e(r,o),n=i.requestAnimationFrame(s)}return{start:function(){t!==!0&&e!==null&&(n=i.requestAnimationFrame(s),t=!0)},stop:function(){i.cancelAnimationFrame(n),t=!1},setAnimationLoop:function(r){e=r},setContext:function(r){i=r}}}function Qx(i){let t=new WeakMap;function e(a,l){let c=a.array,h=a.usage,f=c.byteLength,u=i.createBuffer();i.bindBuffer(l,u),i.bufferData(l,c,h),a.onUploadCallback();let d;if(c instanceof Float32Array)d=i.FLOAT;else if(c instanceof Uint16Array)a.isFloat16BufferAttribute?d=i.HALF_FLOAT:d=i.UNSIGNED_SHORT;else if(c instanceof Int16Array)d=i.SHORT;else if(c instanceof Uint32Array)d=i.UNSIGNED_INT;else if(c instanceof Int32Array)d=i.INT;else if(c instanceof Int8Array)d=i.BYTE;else if(c instanceof Uint8Array)d=i.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)d=i.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:u,type:d,bytesPerElement:c.BYTES_PER_ELEMENT,version:a.version,size:f}}function n(a,l,c){let h=l.array,f=l.updateRanges;if(i.bindBuffer(c,a),f.length===0)i.bufferSubData(c,0,h);else{f.sort((d,m)=>d.start-m.start);let u=0;for(let d=1;d<f.length;d++){let m=f[u],_=f[d];_.start<=m.start+m.count+1?m.count=Math.max(m.count,_.start+_.count-m.start):(++u,f[u]=_)}f.length=u+1;for(let d=0,m=f.length;d<m;d++){let _=f[d];i.bufferSubData(c,_.start*h.BYTES_PER_ELEMENT,h,_.start,_.count)}l.clearUpdateRanges()}l.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),t.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let l=t.get(a);l&&(i.deleteBuffer(l.buffer),t.delete(a))}function o(a,l){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let h=t.get(a);(!h||h.version<a.version)&&t.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let c=t.get(a);if(c===void 0)t.set(a,e(a,l));else if(c.version<a.version){if(c.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,a,l),c.version=a.version}}return{get:s,remove:r,update:o}}var to=class i extends ve{constructor(t=1,e=1,n=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:t,height:e,widthSegments:n,heightSegments:s};let r=t/2,o=e/2,a=Math.floor(n),l=Math.floor(s),c=a+1,h=l+1,f=t/a,u=e/l,d=[],m=[],_=[],g=[];for(let p=0;p<h;p++){let S=p*u-o;for(let v=0;v<c;v++){let y=v*f-r;m.push(y,-S,0),_.push(0,0,1),g.push(v/a),g.push(1-p/l)}}for(let p=0;p<l;p++)for(let S=0;S<a;S++){let v=S+c*p,y=S+c*(p+1),U=S+1+c*(p+1),R=S+1+c*p;d.push(v,y,R),d.push(y,U,R)}this.setIndex(d),this.setAttribute("position",new Qt(m,3)),this.setAttribute("normal",new Qt(_,3)),this.setAttribute("uv",new Qt(g,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.widthSegments,t.heightSegments)}},ty=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,ey=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,ny=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,iy=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,sy=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,ry=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,oy=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,ay=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,ly=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec3 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 ).rgb;
	}
#endif`,cy=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,hy=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,uy=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,fy=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,dy=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,py=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,my=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,gy=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,_y=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,xy=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,yy=`#if defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#elif defined( USE_COLOR )
	diffuseColor.rgb *= vColor;
#endif`,vy=`#if defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#elif defined( USE_COLOR )
	varying vec3 vColor;
#endif`,My=`#if defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#elif defined( USE_COLOR ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec3 vColor;
#endif`,by=`#if defined( USE_COLOR_ALPHA )
	vColor = vec4( 1.0 );
#elif defined( USE_COLOR ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec3( 1.0 );
#endif
#ifdef USE_COLOR
	vColor *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.xyz *= instanceColor.xyz;
#endif
#ifdef USE_BATCHING_COLOR
	vec3 batchingColor = getBatchingColor( getIndirectIndex( gl_DrawID ) );
	vColor.xyz *= batchingColor.xyz;
#endif`,Sy=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
vec3 inverseTransformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( vec4( dir, 0.0 ) * matrix ).xyz );
}
mat3 transposeMat3( const in mat3 m ) {
	mat3 tmp;
	tmp[ 0 ] = vec3( m[ 0 ].x, m[ 1 ].x, m[ 2 ].x );
	tmp[ 1 ] = vec3( m[ 0 ].y, m[ 1 ].y, m[ 2 ].y );
	tmp[ 2 ] = vec3( m[ 0 ].z, m[ 1 ].z, m[ 2 ].z );
	return tmp;
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,wy=`#ifdef ENVMAP_TYPE_CUBE_UV
	#define cubeUV_minMipLevel 4.0
	#define cubeUV_minTileSize 16.0
	float getFace( vec3 direction ) {
		vec3 absDirection = abs( direction );
		float face = - 1.0;
		if ( absDirection.x > absDirection.z ) {
			if ( absDirection.x > absDirection.y )
				face = direction.x > 0.0 ? 0.0 : 3.0;
			else
				face = direction.y > 0.0 ? 1.0 : 4.0;
		} else {
			if ( absDirection.z > absDirection.y )
				face = direction.z > 0.0 ? 2.0 : 5.0;
			else
				face = direction.y > 0.0 ? 1.0 : 4.0;
		}
		return face;
	}
	vec2 getUV( vec3 direction, float face ) {
		vec2 uv;
		if ( face == 0.0 ) {
			uv = vec2( direction.z, direction.y ) / abs( direction.x );
		} else if ( face == 1.0 ) {
			uv = vec2( - direction.x, - direction.z ) / abs( direction.y );
		} else if ( face == 2.0 ) {
			uv = vec2( - direction.x, direction.y ) / abs( direction.z );
		} else if ( face == 3.0 ) {
			uv = vec2( - direction.z, direction.y ) / abs( direction.x );
		} else if ( face == 4.0 ) {
			uv = vec2( - direction.x, direction.z ) / abs( direction.y );
		} else {
			uv = vec2( direction.x, direction.y ) / abs( direction.z );
		}
		return 0.5 * ( uv + 1.0 );
	}
	vec3 bilinearCubeUV( sampler2D envMap, vec3 direction, float mipInt ) {
		float face = getFace( direction );
		float filterInt = max( cubeUV_minMipLevel - mipInt, 0.0 );
		mipInt = max( mipInt, cubeUV_minMipLevel );
		float faceSize = exp2( mipInt );
		highp vec2 uv = getUV( direction, face ) * ( faceSize - 2.0 ) + 1.0;
		if ( face > 2.0 ) {
			uv.y += faceSize;
			face -= 3.0;
		}
		uv.x += face * faceSize;
		uv.x += filterInt * 3.0 * cubeUV_minTileSize;
		uv.y += 4.0 * ( exp2( CUBEUV_MAX_MIP ) - faceSize );
		uv.x *= CUBEUV_TEXEL_WIDTH;
		uv.y *= CUBEUV_TEXEL_HEIGHT;
		#ifdef texture2DGradEXT
			return texture2DGradEXT( envMap, uv, vec2( 0.0 ), vec2( 0.0 ) ).rgb;
		#else
			return texture2D( envMap, uv ).rgb;
		#endif
	}
	#define cubeUV_r0 1.0
	#define cubeUV_m0 - 2.0
	#define cubeUV_r1 0.8
	#define cubeUV_m1 - 1.0
	#define cubeUV_r4 0.4
	#define cubeUV_m4 2.0
	#define cubeUV_r5 0.305
	#define cubeUV_m5 3.0
	#define cubeUV_r6 0.21
	#define cubeUV_m6 4.0
	float roughnessToMip( float roughness ) {
		float mip = 0.0;
		if ( roughness >= cubeUV_r1 ) {
			mip = ( cubeUV_r0 - roughness ) * ( cubeUV_m1 - cubeUV_m0 ) / ( cubeUV_r0 - cubeUV_r1 ) + cubeUV_m0;
		} else if ( roughness >= cubeUV_r4 ) {
			mip = ( cubeUV_r1 - roughness ) * ( cubeUV_m4 - cubeUV_m1 ) / ( cubeUV_r1 - cubeUV_r4 ) + cubeUV_m1;
		} else if ( roughness >= cubeUV_r5 ) {
			mip = ( cubeUV_r4 - roughness ) * ( cubeUV_m5 - cubeUV_m4 ) / ( cubeUV_r4 - cubeUV_r5 ) + cubeUV_m4;
		} else if ( roughness >= cubeUV_r6 ) {
			mip = ( cubeUV_r5 - roughness ) * ( cubeUV_m6 - cubeUV_m5 ) / ( cubeUV_r5 - cubeUV_r6 ) + cubeUV_m5;
		} else {
			mip = - 2.0 * log2( 1.16 * roughness );		}
		return mip;
	}
	vec4 textureCubeUV( sampler2D envMap, vec3 sampleDir, float roughness ) {
		float mip = clamp( roughnessToMip( roughness ), cubeUV_m0, CUBEUV_MAX_MIP );
		float mipF = fract( mip );
		float mipInt = floor( mip );
		vec3 color0 = bilinearCubeUV( envMap, sampleDir, mipInt );
		if ( mipF == 0.0 ) {
			return vec4( color0, 1.0 );
		} else {
			vec3 color1 = bilinearCubeUV( envMap, sampleDir, mipInt + 1.0 );
			return vec4( mix( color0, color1, mipF ), 1.0 );
		}
	}
#endif`,Ey=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
	#ifdef FLIP_SIDED
		transformedTangent = - transformedTangent;
	#endif
#endif`,Ty=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,Ay=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,Cy=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,Ry=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,Py="gl_FragColor = linearToOutputTexel( gl_FragColor );",Iy=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,Ly=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = inverseTransformDirection( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * vec3( flipEnvMap * reflectVec.x, reflectVec.yz ) );
	#else
		vec4 envColor = vec4( 0.0 );
	#endif
	#ifdef ENVMAP_BLENDING_MULTIPLY
		outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
	#elif defined( ENVMAP_BLENDING_MIX )
		outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
	#elif defined( ENVMAP_BLENDING_ADD )
		outgoingLight += envColor.xyz * specularStrength * reflectivity;
	#endif
#endif`,Dy=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform float flipEnvMap;
	uniform mat3 envMapRotation;
	#ifdef ENVMAP_TYPE_CUBE
		uniform samplerCube envMap;
	#else
		uniform sampler2D envMap;
	#endif
	
#endif`,Uy=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,Ny=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,Fy=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = inverseTransformDirection( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,Oy=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,By=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,zy=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,ky=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,Vy=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,Hy=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,Gy=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,Wy=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,Xy=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = inverseTransformDirection( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif`,qy=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_CUBE_UV
			vec3 worldNormal = inverseTransformDirection( normal, viewMatrix );
			vec4 envMapColor = textureCubeUV( envMap, envMapRotation * worldNormal, 1.0 );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_CUBE_UV
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, roughness * roughness) );
			reflectVec = inverseTransformDirection( reflectVec, viewMatrix );
			vec4 envMapColor = textureCubeUV( envMap, envMapRotation * reflectVec, roughness );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_CUBE_UV
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
#endif`,Yy=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,$y=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,Zy=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,Jy=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,Ky=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb * ( 1.0 - metalnessFactor );
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.0525 );material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = mix( min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = mix( vec3( 0.04 ), diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.0525 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.07, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,jy=`struct PhysicalMaterial {
	vec3 diffuseColor;
	float roughness;
	vec3 specularColor;
	float specularF90;
	float dispersion;
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		float v = 0.5 / ( gv + gl );
		return saturate(v);
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = material.clearcoatRoughness;
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColor;
	float f90 = material.specularF90;
	float roughness = material.roughness;
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float V = V_GGX_SmithCorrelated_Anisotropic( material.alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( material.alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transposeMat3( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float a = roughness < 0.25 ? -339.2 * r2 + 161.4 * roughness - 25.9 : -8.48 * r2 + 14.3 * roughness - 9.95;
	float b = roughness < 0.25 ? 44.0 * r2 - 23.7 * roughness + 3.26 : 1.97 * r2 - 3.27 * roughness + 0.72;
	float DG = exp( a * dotNV + b ) + ( roughness < 0.25 ? 0.0 : 0.1 * ( roughness - 0.25 ) );
	return saturate( DG * RECIPROCAL_PI );
}
vec2 DFGApprox( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	const vec4 c0 = vec4( - 1, - 0.0275, - 0.572, 0.022 );
	const vec4 c1 = vec4( 1, 0.0425, 1.04, - 0.04 );
	vec4 r = roughness * c0 + c1;
	float a004 = min( r.x * r.x, exp2( - 9.28 * dotNV ) ) * r.x + r.y;
	vec2 fab = vec2( - 1.04, 1.04 ) * a004 + r.zw;
	return fab;
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	vec2 fab = DFGApprox( normal, viewDir, roughness );
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, const in float roughness, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	vec2 fab = DFGApprox( normal, viewDir, roughness );
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColor * t2.x + ( vec3( 1.0 ) - material.specularColor ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseColor * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
	#endif
	reflectedLight.directSpecular += irradiance * BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
	#endif
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( geometryNormal, geometryViewDir, material.specularColor, material.specularF90, material.iridescence, material.iridescenceFresnel, material.roughness, singleScattering, multiScattering );
	#else
		computeMultiscattering( geometryNormal, geometryViewDir, material.specularColor, material.specularF90, material.roughness, singleScattering, multiScattering );
	#endif
	vec3 totalScattering = singleScattering + multiScattering;
	vec3 diffuse = material.diffuseColor * ( 1.0 - max( max( totalScattering.r, totalScattering.g ), totalScattering.b ) );
	reflectedLight.indirectSpecular += radiance * singleScattering;
	reflectedLight.indirectSpecular += multiScattering * cosineWeightedIrradiance;
	reflectedLight.indirectDiffuse += diffuse * cosineWeightedIrradiance;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,Qy=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		material.iridescenceFresnel = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		material.iridescenceF0 = Schlick_to_F0( material.iridescenceFresnel, 1.0, dotNVi );
	}
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,tv=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD ) && defined( ENVMAP_TYPE_CUBE_UV )
		iblIrradiance += getIBLIrradiance( geometryNormal );
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		radiance += getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		radiance += getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,ev=`#if defined( RE_IndirectDiffuse )
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,nv=`#if defined( USE_LOGDEPTHBUF )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,iv=`#if defined( USE_LOGDEPTHBUF )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,sv=`#ifdef USE_LOGDEPTHBUF
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,rv=`#ifdef USE_LOGDEPTHBUF
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,ov=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,av=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,lv=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,cv=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,hv=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,uv=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,fv=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,dv=`#if defined( USE_MORPHCOLORS )
	vColor *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,pv=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,mv=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,gv=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,_v=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#if defined( DOUBLE_SIDED ) && ! defined( FLAT_SHADED )
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#if defined( DOUBLE_SIDED ) && ! defined( FLAT_SHADED )
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,xv=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,yv=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,vv=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,Mv=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
	#endif
#endif`,bv=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,Sv=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,wv=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,Ev=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,Tv=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,Av=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,Cv=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	return depth * ( near - far ) - near;
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	return ( near * far ) / ( ( far - near ) * depth - far );
}`,Rv=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,Pv=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,Iv=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,Lv=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,Dv=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,Uv=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,Nv=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform sampler2D pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	float texture2DCompare( sampler2D depths, vec2 uv, float compare ) {
		return step( compare, unpackRGBAToDepth( texture2D( depths, uv ) ) );
	}
	vec2 texture2DDistribution( sampler2D shadow, vec2 uv ) {
		return unpackRGBATo2Half( texture2D( shadow, uv ) );
	}
	float VSMShadow (sampler2D shadow, vec2 uv, float compare ){
		float occlusion = 1.0;
		vec2 distribution = texture2DDistribution( shadow, uv );
		float hard_shadow = step( compare , distribution.x );
		if (hard_shadow != 1.0 ) {
			float distance = compare - distribution.x ;
			float variance = max( 0.00000, distribution.y * distribution.y );
			float softness_probability = variance / (variance + distance * distance );			softness_probability = clamp( ( softness_probability - 0.3 ) / ( 0.95 - 0.3 ), 0.0, 1.0 );			occlusion = clamp( max( hard_shadow, softness_probability ), 0.0, 1.0 );
		}
		return occlusion;
	}
	float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
		float shadow = 1.0;
		shadowCoord.xyz /= shadowCoord.w;
		shadowCoord.z += shadowBias;
		bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
		bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
		if ( frustumTest ) {
		#if defined( SHADOWMAP_TYPE_PCF )
			vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
			float dx0 = - texelSize.x * shadowRadius;
			float dy0 = - texelSize.y * shadowRadius;
			float dx1 = + texelSize.x * shadowRadius;
			float dy1 = + texelSize.y * shadowRadius;
			float dx2 = dx0 / 2.0;
			float dy2 = dy0 / 2.0;
			float dx3 = dx1 / 2.0;
			float dy3 = dy1 / 2.0;
			shadow = (
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx0, dy0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( 0.0, dy0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx1, dy0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx2, dy2 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( 0.0, dy2 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx3, dy2 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx0, 0.0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx2, 0.0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy, shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx3, 0.0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx1, 0.0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx2, dy3 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( 0.0, dy3 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx3, dy3 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx0, dy1 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( 0.0, dy1 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, shadowCoord.xy + vec2( dx1, dy1 ), shadowCoord.z )
			) * ( 1.0 / 17.0 );
		#elif defined( SHADOWMAP_TYPE_PCF_SOFT )
			vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
			float dx = texelSize.x;
			float dy = texelSize.y;
			vec2 uv = shadowCoord.xy;
			vec2 f = fract( uv * shadowMapSize + 0.5 );
			uv -= f * texelSize;
			shadow = (
				texture2DCompare( shadowMap, uv, shadowCoord.z ) +
				texture2DCompare( shadowMap, uv + vec2( dx, 0.0 ), shadowCoord.z ) +
				texture2DCompare( shadowMap, uv + vec2( 0.0, dy ), shadowCoord.z ) +
				texture2DCompare( shadowMap, uv + texelSize, shadowCoord.z ) +
				mix( texture2DCompare( shadowMap, uv + vec2( -dx, 0.0 ), shadowCoord.z ),
					 texture2DCompare( shadowMap, uv + vec2( 2.0 * dx, 0.0 ), shadowCoord.z ),
					 f.x ) +
				mix( texture2DCompare( shadowMap, uv + vec2( -dx, dy ), shadowCoord.z ),
					 texture2DCompare( shadowMap, uv + vec2( 2.0 * dx, dy ), shadowCoord.z ),
					 f.x ) +
				mix( texture2DCompare( shadowMap, uv + vec2( 0.0, -dy ), shadowCoord.z ),
					 texture2DCompare( shadowMap, uv + vec2( 0.0, 2.0 * dy ), shadowCoord.z ),
					 f.y ) +
				mix( texture2DCompare( shadowMap, uv + vec2( dx, -dy ), shadowCoord.z ),
					 texture2DCompare( shadowMap, uv + vec2( dx, 2.0 * dy ), shadowCoord.z ),
					 f.y ) +
				mix( mix( texture2DCompare( shadowMap, uv + vec2( -dx, -dy ), shadowCoord.z ),
						  texture2DCompare( shadowMap, uv + vec2( 2.0 * dx, -dy ), shadowCoord.z ),
						  f.x ),
					 mix( texture2DCompare( shadowMap, uv + vec2( -dx, 2.0 * dy ), shadowCoord.z ),
						  texture2DCompare( shadowMap, uv + vec2( 2.0 * dx, 2.0 * dy ), shadowCoord.z ),
						  f.x ),
					 f.y )
			) * ( 1.0 / 9.0 );
		#elif defined( SHADOWMAP_TYPE_VSM )
			shadow = VSMShadow( shadowMap, shadowCoord.xy, shadowCoord.z );
		#else
			shadow = texture2DCompare( shadowMap, shadowCoord.xy, shadowCoord.z );
		#endif
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	vec2 cubeToUV( vec3 v, float texelSizeY ) {
		vec3 absV = abs( v );
		float scaleToCube = 1.0 / max( absV.x, max( absV.y, absV.z ) );
		absV *= scaleToCube;
		v *= scaleToCube * ( 1.0 - 2.0 * texelSizeY );
		vec2 planar = v.xy;
		float almostATexel = 1.5 * texelSizeY;
		float almostOne = 1.0 - almostATexel;
		if ( absV.z >= almostOne ) {
			if ( v.z > 0.0 )
				planar.x = 4.0 - v.x;
		} else if ( absV.x >= almostOne ) {
			float signX = sign( v.x );
			planar.x = v.z * signX + 2.0 * signX;
		} else if ( absV.y >= almostOne ) {
			float signY = sign( v.y );
			planar.x = v.x + 2.0 * signY + 2.0;
			planar.y = v.z * signY - 2.0;
		}
		return vec2( 0.125, 0.25 ) * planar + vec2( 0.375, 0.75 );
	}
	float getPointShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		
		float lightToPositionLength = length( lightToPosition );
		if ( lightToPositionLength - shadowCameraFar <= 0.0 && lightToPositionLength - shadowCameraNear >= 0.0 ) {
			float dp = ( lightToPositionLength - shadowCameraNear ) / ( shadowCameraFar - shadowCameraNear );			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			vec2 texelSize = vec2( 1.0 ) / ( shadowMapSize * vec2( 4.0, 2.0 ) );
			#if defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_PCF_SOFT ) || defined( SHADOWMAP_TYPE_VSM )
				vec2 offset = vec2( - 1, 1 ) * shadowRadius * texelSize.y;
				shadow = (
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.xyy, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.yyy, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.xyx, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.yyx, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.xxy, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.yxy, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.xxx, texelSize.y ), dp ) +
					texture2DCompare( shadowMap, cubeToUV( bd3D + offset.yxx, texelSize.y ), dp )
				) * ( 1.0 / 9.0 );
			#else
				shadow = texture2DCompare( shadowMap, cubeToUV( bd3D, texelSize.y ), dp );
			#endif
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
#endif`,Fv=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,Ov=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	vec3 shadowWorldNormal = inverseTransformDirection( transformedNormal, viewMatrix );
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,Bv=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,zv=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,kv=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,Vv=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,Hv=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,Gv=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,Wv=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,Xv=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,qv=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,Yv=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = inverseTransformDirection( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseColor, material.specularColor, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,$v=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
		
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
		
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		
		#else
		
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,Zv=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,Jv=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,Kv=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,jv=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,Qv=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,tM=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,eM=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,nM=`#ifdef ENVMAP_TYPE_CUBE
	uniform samplerCube envMap;
#elif defined( ENVMAP_TYPE_CUBE_UV )
	uniform sampler2D envMap;
#endif
uniform float flipEnvMap;
uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <cube_uv_reflection_fragment>
void main() {
	#ifdef ENVMAP_TYPE_CUBE
		vec4 texColor = textureCube( envMap, backgroundRotation * vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) );
	#elif defined( ENVMAP_TYPE_CUBE_UV )
		vec4 texColor = textureCubeUV( envMap, backgroundRotation * vWorldDirection, backgroundBlurriness );
	#else
		vec4 texColor = vec4( 0.0, 0.0, 0.0, 1.0 );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,iM=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,sM=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,rM=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,oM=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	float fragCoordZ = 0.5 * vHighPrecisionZW[0] / vHighPrecisionZW[1] + 0.5;
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,aM=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,lM=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main () {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = packDepthToRGBA( dist );
}`,cM=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,hM=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,uM=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,fM=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,dM=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,pM=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,mM=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,gM=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <packing>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,_M=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,xM=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,yM=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,vM=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <packing>
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( packNormalToRGB( normal ), diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,MM=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,bM=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <packing>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,SM=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,wM=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <packing>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <cube_uv_reflection_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
		float sheenEnergyComp = 1.0 - 0.157 * max3( material.sheenColor );
		outgoingLight = outgoingLight * sheenEnergyComp + sheenSpecularDirect + sheenSpecularIndirect;
	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,EM=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,TM=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <packing>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,AM=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,CM=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,RM=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,PM=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <packing>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,IM=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,LM=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,he={alphahash_fragment:ty,alphahash_pars_fragment:ey,alphamap_fragment:ny,alphamap_pars_fragment:iy,alphatest_fragment:sy,alphatest_pars_fragment:ry,aomap_fragment:oy,aomap_pars_fragment:ay,batching_pars_vertex:ly,batching_vertex:cy,begin_vertex:hy,beginnormal_vertex:uy,bsdfs:fy,iridescence_fragment:dy,bumpmap_pars_fragment:py,clipping_planes_fragment:my,clipping_planes_pars_fragment:gy,clipping_planes_pars_vertex:_y,clipping_planes_vertex:xy,color_fragment:yy,color_pars_fragment:vy,color_pars_vertex:My,color_vertex:by,common:Sy,cube_uv_reflection_fragment:wy,defaultnormal_vertex:Ey,displacementmap_pars_vertex:Ty,displacementmap_vertex:Ay,emissivemap_fragment:Cy,emissivemap_pars_fragment:Ry,colorspace_fragment:Py,colorspace_pars_fragment:Iy,envmap_fragment:Ly,envmap_common_pars_fragment:Dy,envmap_pars_fragment:Uy,envmap_pars_vertex:Ny,envmap_physical_pars_fragment:qy,envmap_vertex:Fy,fog_vertex:Oy,fog_pars_vertex:By,fog_fragment:zy,fog_pars_fragment:ky,gradientmap_pars_fragment:Vy,lightmap_pars_fragment:Hy,lights_lambert_fragment:Gy,lights_lambert_pars_fragment:Wy,lights_pars_begin:Xy,lights_toon_fragment:Yy,lights_toon_pars_fragment:$y,lights_phong_fragment:Zy,lights_phong_pars_fragment:Jy,lights_physical_fragment:Ky,lights_physical_pars_fragment:jy,lights_fragment_begin:Qy,lights_fragment_maps:tv,lights_fragment_end:ev,logdepthbuf_fragment:nv,logdepthbuf_pars_fragment:iv,logdepthbuf_pars_vertex:sv,logdepthbuf_vertex:rv,map_fragment:ov,map_pars_fragment:av,map_particle_fragment:lv,map_particle_pars_fragment:cv,metalnessmap_fragment:hv,metalnessmap_pars_fragment:uv,morphinstance_vertex:fv,morphcolor_vertex:dv,morphnormal_vertex:pv,morphtarget_pars_vertex:mv,morphtarget_vertex:gv,normal_fragment_begin:_v,normal_fragment_maps:xv,normal_pars_fragment:yv,normal_pars_vertex:vv,normal_vertex:Mv,normalmap_pars_fragment:bv,clearcoat_normal_fragment_begin:Sv,clearcoat_normal_fragment_maps:wv,clearcoat_pars_fragment:Ev,iridescence_pars_fragment:Tv,opaque_fragment:Av,packing:Cv,premultiplied_alpha_fragment:Rv,project_vertex:Pv,dithering_fragment:Iv,dithering_pars_fragment:Lv,roughnessmap_fragment:Dv,roughnessmap_pars_fragment:Uv,shadowmap_pars_fragment:Nv,shadowmap_pars_vertex:Fv,shadowmap_vertex:Ov,shadowmask_pars_fragment:Bv,skinbase_vertex:zv,skinning_pars_vertex:kv,skinning_vertex:Vv,skinnormal_vertex:Hv,specularmap_fragment:Gv,specularmap_pars_fragment:Wv,tonemapping_fragment:Xv,tonemapping_pars_fragment:qv,transmission_fragment:Yv,transmission_pars_fragment:$v,uv_pars_fragment:Zv,uv_pars_vertex:Jv,uv_vertex:Kv,worldpos_vertex:jv,background_vert:Qv,background_frag:tM,backgroundCube_vert:eM,backgroundCube_frag:nM,cube_vert:iM,cube_frag:sM,depth_vert:rM,depth_frag:oM,distanceRGBA_vert:aM,distanceRGBA_frag:lM,equirect_vert:cM,equirect_frag:hM,linedashed_vert:uM,linedashed_frag:fM,meshbasic_vert:dM,meshbasic_frag:pM,meshlambert_vert:mM,meshlambert_frag:gM,meshmatcap_vert:_M,meshmatcap_frag:xM,meshnormal_vert:yM,meshnormal_frag:vM,meshphong_vert:MM,meshphong_frag:bM,meshphysical_vert:SM,meshphysical_frag:wM,meshtoon_vert:EM,meshtoon_frag:TM,points_vert:AM,points_frag:CM,shadow_vert:RM,shadow_frag:PM,sprite_vert:IM,sprite_frag:LM},bt={common:{diffuse:{value:new oe(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new le},alphaMap:{value:null},alphaMapTransform:{value:new le},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new le}},envmap:{envMap:{value:null},envMapRotation:{value:new le},flipEnvMap:{value:-1},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new le}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new le}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new le},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new le},normalScale:{value:new gt(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new le},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new le}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new le}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new le}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new oe(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMap:{value:[]},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotShadowMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMap:{value:[]},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null}},points:{diffuse:{value:new oe(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new le},alphaTest:{value:0},uvTransform:{value:new le}},sprite:{diffuse:{value:new oe(16777215)},opacity:{value:1},center:{value:new gt(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new le},alphaMap:{value:null},alphaMapTransform:{value:new le},alphaTest:{value:0}}},Nn={basic:{uniforms:Dn([bt.common,bt.specularmap,bt.envmap,bt.aomap,bt.lightmap,bt.fog]),vertexShader:he.meshbasic_vert,fragmentShader:he.meshbasic_frag},lambert:{uniforms:Dn([bt.common,bt.specularmap,bt.envmap,bt.aomap,bt.lightmap,bt.emissivemap,bt.bumpmap,bt.normalmap,bt.displacementmap,bt.fog,bt.lights,{emissive:{value:new oe(0)}}]),vertexShader:he.meshlambert_vert,fragmentShader:he.meshlambert_frag},phong:{uniforms:Dn([bt.common,bt.specularmap,bt.envmap,bt.aomap,bt.lightmap,bt.emissivemap,bt.bumpmap,bt.normalmap,bt.displacementmap,bt.fog,bt.lights,{emissive:{value:new oe(0)},specular:{value:new oe(1118481)},shininess:{value:30}}]),vertexShader:he.meshphong_vert,fragmentShader:he.meshphong_frag},standard:{uniforms:Dn([bt.common,bt.envmap,bt.aomap,bt.lightmap,bt.emissivemap,bt.bumpmap,bt.normalmap,bt.displacementmap,bt.roughnessmap,bt.metalnessmap,bt.fog,bt.lights,{emissive:{value:new oe(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:he.meshphysical_vert,fragmentShader:he.meshphysical_frag},toon:{uniforms:Dn([bt.common,bt.aomap,bt.lightmap,bt.emissivemap,bt.bumpmap,bt.normalmap,bt.displacementmap,bt.gradientmap,bt.fog,bt.lights,{emissive:{value:new oe(0)}}]),vertexShader:he.meshtoon_vert,fragmentShader:he.meshtoon_frag},matcap:{uniforms:Dn([bt.common,bt.bumpmap,bt.normalmap,bt.displacementmap,bt.fog,{matcap:{value:null}}]),vertexShader:he.meshmatcap_vert,fragmentShader:he.meshmatcap_frag},points:{uniforms:Dn([bt.points,bt.fog]),vertexShader:he.points_vert,fragmentShader:he.points_frag},dashed:{uniforms:Dn([bt.common,bt.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:he.linedashed_vert,fragmentShader:he.linedashed_frag},depth:{uniforms:Dn([bt.common,bt.displacementmap]),vertexShader:he.depth_vert,fragmentShader:he.depth_frag},normal:{uniforms:Dn([bt.common,bt.bumpmap,bt.normalmap,bt.displacementmap,{opacity:{value:1}}]),vertexShader:he.meshnormal_vert,fragmentShader:he.meshnormal_frag},sprite:{uniforms:Dn([bt.sprite,bt.fog]),vertexShader:he.sprite_vert,fragmentShader:he.sprite_frag},background:{uniforms:{uvTransform:{value:new le},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:he.background_vert,fragmentShader:he.background_frag},backgroundCube:{uniforms:{envMap:{value:null},flipEnvMap:{value:-1},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new le}},vertexShader:he.backgroundCube_vert,fragmentShader:he.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:he.cube_vert,fragmentShader:he.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:he.equirect_vert,fragmentShader:he.equirect_frag},distanceRGBA:{uniforms:Dn([bt.common,bt.displacementmap,{referencePosition:{value:new D},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:he.distanceRGBA_vert,fragmentShader:he.distanceRGBA_frag},shadow:{uniforms:Dn([bt.lights,bt.fog,{color:{value:new oe(0)},opacity:{value:1}}]),vertexShader:he.shadow_vert,fragmentShader:he.shadow_frag}};Nn.physical={uniforms:Dn([Nn.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new le},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new le},clearcoatNormalScale:{value:new gt(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new le},dispersion:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new le},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new le},sheen:{value:0},sheenColor:{value:new oe(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new le},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new le},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new le},transmissionSamplerSize:{value:new gt},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new le},attenuationDistance:{value:0},attenuationColor:{value:new oe(0)},specularColor:{value:new oe(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new le},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new le},anisotropyVector:{value:new gt},anisotropyMap:{value:null},anisotropyMapTransform:{value:new le}}]),vertexShader:he.meshphysical_vert,fragmentShader:he.meshphysical_frag};var za={r:0,b:0,g:0},$s=new ki,DM=new ze;function UM(i,t,e,n,s,r,o){let a=new oe(0),l=r===!0?0:1,c,h,f=null,u=0,d=null;function m(S){let v=S.isScene===!0?S.background:null;return v&&v.isTexture&&(v=(S.backgroundBlurriness>0?e:t).get(v)),v}function _(S){let v=!1,y=m(S);y===null?p(a,l):y&&y.isColor&&(p(y,1),v=!0);let U=i.xr.getEnvironmentBlendMode();U==="additive"?n.buffers.color.setClear(0,0,0,1,o):U==="alpha-blend"&&n.buffers.color.setClear(0,0,0,0,o),(i.autoClear||v)&&(n.buffers.depth.setTest(!0),n.buffers.depth.setMask(!0),n.buffers.color.setMask(!0),i.clear(i.autoClearColor,i.autoClearDepth,i.autoClearStencil))}function g(S,v){let y=m(v);y&&(y.isCubeTexture||y.mapping===zl)?(h===void 0&&(h=new xe(new Vi(1,1,1),new ai({name:"BackgroundCubeMaterial",uniforms:Qr(Nn.backgroundCube.uniforms),vertexShader:Nn.backgroundCube.vertexShader,fragmentShader:Nn.backgroundCube.fragmentShader,side:zn,depthTest:!1,depthWrite:!1,fog:!1})),h.geometry.deleteAttribute("normal"),h.geometry.deleteAttribute("uv"),h.onBeforeRender=function(U,R,P){this.matrixWorld.copyPosition(P.matrixWorld)},Object.defineProperty(h.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),s.update(h)),$s.copy(v.backgroundRotation),$s.x*=-1,$s.y*=-1,$s.z*=-1,y.isCubeTexture&&y.isRenderTargetTexture===!1&&($s.y*=-1,$s.z*=-1),h.material.uniforms.envMap.value=y,h.material.uniforms.flipEnvMap.value=y.isCubeTexture&&y.isRenderTargetTexture===!1?-1:1,h.material.uniforms.backgroundBlurriness.value=v.backgroundBlurriness,h.material.uniforms.backgroundIntensity.value=v.backgroundIntensity,h.material.uniforms.backgroundRotation.value.setFromMatrix4(DM.makeRotationFromEuler($s)),h.material.toneMapped=be.getTransfer(y.colorSpace)!==Le,(f!==y||u!==y.version||d!==i.toneMapping)&&(h.material.needsUpdate=!0,f=y,u=y.version,d=i.toneMapping),h.layers.enableAll(),S.unshift(h,h.geometry,h.material,0,0,null)):y&&y.isTexture&&(c===void 0&&(c=new xe(new to(2,2),new ai({name:"BackgroundMaterial",uniforms:Qr(Nn.background.uniforms),vertexShader:Nn.background.vertexShader,fragmentShader:Nn.background.fragmentShader,side:Ls,depthTest:!1,depthWrite:!1,fog:!1})),c.geometry.deleteAttribute("normal"),Object.defineProperty(c.material,"map",{get:function(){return this.uniforms.t2D.value}}),s.update(c)),c.material.uniforms.t2D.value=y,c.material.uniforms.backgroundIntensity.value=v.backgroundIntensity,c.material.toneMapped=be.getTransfer(y.colorSpace)!==Le,y.matrixAutoUpdate===!0&&y.updateMatrix(),c.material.uniforms.uvTransform.value.copy(y.matrix),(f!==y||u!==y.version||d!==i.toneMapping)&&(c.material.needsUpdate=!0,f=y,u=y.version,d=i.toneMapping),c.layers.enableAll(),S.unshift(c,c.geometry,c.material,0,0,null))}function p(S,v){S.getRGB(za,ym(i)),n.buffers.color.setClear(za.r,za.g,za.b,v,o)}return{getClearColor:function(){return a},setClearColor:function(S,v=1){a.set(S),l=v,p(a,l)},getClearAlpha:function(){return l},setClearAlpha:function(S){l=S,p(a,l)},render:_,addToRenderList:g}}function NM(i,t){let e=i.getParameter(i.MAX_VERTEX_ATTRIBS),n={},s=u(null),r=s,o=!1;function a(M,A,W,G,X){let Z=!1,Y=f(G,W,A);r!==Y&&(r=Y,c(r.object)),Z=d(M,G,W,X),Z&&m(M,G,W,X),X!==null&&t.update(X,i.ELEMENT_ARRAY_BUFFER),(Z||o)&&(o=!1,y(M,A,W,G),X!==null&&i.bindBuffer(i.ELEMENT_ARRAY_BUFFER,t.get(X).buffer))}function l(){return i.createVertexArray()}function c(M){return i.bindVertexArray(M)}function h(M){return i.deleteVertexArray(M)}function f(M,A,W){let G=W.wireframe===!0,X=n[M.id];X===void 0&&(X={},n[M.id]=X);let Z=X[A.id];Z===void 0&&(Z={},X[A.id]=Z);let Y=Z[G];return Y===void 0&&(Y=u(l()),Z[G]=Y),Y}function u(M){let A=[],W=[],G=[];for(let X=0;X<e;X++)A[X]=0,W[X]=0,G[X]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:A,enabledAttributes:W,attributeDivisors:G,object:M,attributes:{},index:null}}function d(M,A,W,G){let X=r.attributes,Z=A.attributes,Y=0,nt=W.getAttributes();for(let Q in nt)if(nt[Q].location>=0){let at=X[Q],_t=Z[Q];if(_t===void 0&&(Q==="instanceMatrix"&&M.instanceMatrix&&(_t=M.instanceMatrix),Q==="instanceColor"&&M.instanceColor&&(_t=M.instanceColor)),at===void 0||at.attribute!==_t||_t&&at.data!==_t.data)return!0;Y++}return r.attributesNum!==Y||r.index!==G}function m(M,A,W,G){let X={},Z=A.attributes,Y=0,nt=W.getAttributes();for(let Q in nt)if(nt[Q].location>=0){let at=Z[Q];at===void 0&&(Q==="instanceMatrix"&&M.instanceMatrix&&(at=M.instanceMatrix),Q==="instanceColor"&&M.instanceColor&&(at=M.instanceColor));let _t={};_t.attribute=at,at&&at.data&&(_t.data=at.data),X[Q]=_t,Y++}r.attributes=X,r.attributesNum=Y,r.index=G}function _(){let M=r.newAttributes;for(let A=0,W=M.length;A<W;A++)M[A]=0}function g(M){p(M,0)}function p(M,A){let W=r.newAttributes,G=r.enabledAttributes,X=r.attributeDivisors;W[M]=1,G[M]===0&&(i.enableVertexAttribArray(M),G[M]=1),X[M]!==A&&(i.vertexAttribDivisor(M,A),X[M]=A)}function S(){let M=r.newAttributes,A=r.enabledAttributes;for(let W=0,G=A.length;W<G;W++)A[W]!==M[W]&&(i.disableVertexAttribArray(W),A[W]=0)}function v(M,A,W,G,X,Z,Y){Y===!0?i.vertexAttribIPointer(M,A,W,X,Z):i.vertexAttribPointer(M,A,W,G,X,Z)}function y(M,A,W,G){_();let X=G.attributes,Z=W.getAttributes(),Y=A.defaultAttributeValues;for(let nt in Z){let Q=Z[nt];if(Q.location>=0){let dt=X[nt];if(dt===void 0&&(nt==="instanceMatrix"&&M.instanceMatrix&&(dt=M.instanceMatrix),nt==="instanceColor"&&M.instanceColor&&(dt=M.instanceColor)),dt!==void 0){let at=dt.normalized,_t=dt.itemSize,pt=t.get(dt);if(pt===void 0)continue;let Zt=pt.buffer,J=pt.type,ht=pt.bytesPerElement,Ot=J===i.INT||J===i.UNSIGNED_INT||dt.gpuType===rf;if(dt.isInterleavedBufferAttribute){let lt=dt.data,Ft=lt.stride,Yt=dt.offset;if(lt.isInstancedInterleavedBuffer){for(let Ut=0;Ut<Q.locationSize;Ut++)p(Q.location+Ut,lt.meshPerAttribute);M.isInstancedMesh!==!0&&G._maxInstanceCount===void 0&&(G._maxInstanceCount=lt.meshPerAttribute*lt.count)}else for(let Ut=0;Ut<Q.locationSize;Ut++)g(Q.location+Ut);i.bindBuffer(i.ARRAY_BUFFER,Zt);for(let Ut=0;Ut<Q.locationSize;Ut++)v(Q.location+Ut,_t/Q.locationSize,J,at,Ft*ht,(Yt+_t/Q.locationSize*Ut)*ht,Ot)}else{if(dt.isInstancedBufferAttribute){for(let lt=0;lt<Q.locationSize;lt++)p(Q.location+lt,dt.meshPerAttribute);M.isInstancedMesh!==!0&&G._maxInstanceCount===void 0&&(G._maxInstanceCount=dt.meshPerAttribute*dt.count)}else for(let lt=0;lt<Q.locationSize;lt++)g(Q.location+lt);i.bindBuffer(i.ARRAY_BUFFER,Zt);for(let lt=0;lt<Q.locationSize;lt++)v(Q.location+lt,_t/Q.locationSize,J,at,_t*ht,_t/Q.locationSize*lt*ht,Ot)}}else if(Y!==void 0){let at=Y[nt];if(at!==void 0)switch(at.length){case 2:i.vertexAttrib2fv(Q.location,at);break;case 3:i.vertexAttrib3fv(Q.location,at);break;case 4:i.vertexAttrib4fv(Q.location,at);break;default:i.vertexAttrib1fv(Q.location,at)}}}}S()}function U(){F();for(let M in n){let A=n[M];for(let W in A){let G=A[W];for(let X in G)h(G[X].object),delete G[X];delete A[W]}delete n[M]}}function R(M){if(n[M.id]===void 0)return;let A=n[M.id];for(let W in A){let G=A[W];for(let X in G)h(G[X].object),delete G[X];delete A[W]}delete n[M.id]}function P(M){for(let A in n){let W=n[A];if(W[M.id]===void 0)continue;let G=W[M.id];for(let X in G)h(G[X].object),delete G[X];delete W[M.id]}}function F(){E(),o=!0,r!==s&&(r=s,c(r.object))}function E(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:F,resetDefaultState:E,dispose:U,releaseStatesOfGeometry:R,releaseStatesOfProgram:P,initAttributes:_,enableAttribute:g,disableUnusedAttributes:S}}function FM(i,t,e){let n;function s(c){n=c}function r(c,h){i.drawArrays(n,c,h),e.update(h,n,1)}function o(c,h,f){f!==0&&(i.drawArraysInstanced(n,c,h,f),e.update(h,n,f))}function a(c,h,f){if(f===0)return;t.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,c,0,h,0,f);let d=0;for(let m=0;m<f;m++)d+=h[m];e.update(d,n,1)}function l(c,h,f,u){if(f===0)return;let d=t.get("WEBGL_multi_draw");if(d===null)for(let m=0;m<c.length;m++)o(c[m],h[m],u[m]);else{d.multiDrawArraysInstancedWEBGL(n,c,0,h,0,u,0,f);let m=0;for(let _=0;_<f;_++)m+=h[_]*u[_];e.update(m,n,1)}}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a,this.renderMultiDrawInstances=l}function OM(i,t,e,n){let s;function r(){if(s!==void 0)return s;if(t.has("EXT_texture_filter_anisotropic")===!0){let P=t.get("EXT_texture_filter_anisotropic");s=i.getParameter(P.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(P){return!(P!==Mi&&n.convert(P)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(P){let F=P===Yo&&(t.has("EXT_color_buffer_half_float")||t.has("EXT_color_buffer_float"));return!(P!==ls&&n.convert(P)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_TYPE)&&P!==rs&&!F)}function l(P){if(P==="highp"){if(i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.HIGH_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.HIGH_FLOAT).precision>0)return"highp";P="mediump"}return P==="mediump"&&i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.MEDIUM_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=e.precision!==void 0?e.precision:"highp",h=l(c);h!==c&&(console.warn("THREE.WebGLRenderer:",c,"not supported, using",h,"instead."),c=h);let f=e.logarithmicDepthBuffer===!0,u=e.reverseDepthBuffer===!0&&t.has("EXT_clip_control"),d=i.getParameter(i.MAX_TEXTURE_IMAGE_UNITS),m=i.getParameter(i.MAX_VERTEX_TEXTURE_IMAGE_UNITS),_=i.getParameter(i.MAX_TEXTURE_SIZE),g=i.getParameter(i.MAX_CUBE_MAP_TEXTURE_SIZE),p=i.getParameter(i.MAX_VERTEX_ATTRIBS),S=i.getParameter(i.MAX_VERTEX_UNIFORM_VECTORS),v=i.getParameter(i.MAX_VARYING_VECTORS),y=i.getParameter(i.MAX_FRAGMENT_UNIFORM_VECTORS),U=m>0,R=i.getParameter(i.MAX_SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:o,textureTypeReadable:a,precision:c,logarithmicDepthBuffer:f,reverseDepthBuffer:u,maxTextures:d,maxVertexTextures:m,maxTextureSize:_,maxCubemapSize:g,maxAttributes:p,maxVertexUniforms:S,maxVaryings:v,maxFragmentUniforms:y,vertexTextures:U,maxSamples:R}}function BM(i){let t=this,e=null,n=0,s=!1,r=!1,o=new Yn,a=new le,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(f,u){let d=f.length!==0||u||n!==0||s;return s=u,n=f.length,d},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(f,u){e=h(f,u,0)},this.setState=function(f,u,d){let m=f.clippingPlanes,_=f.clipIntersection,g=f.clipShadows,p=i.get(f);if(!s||m===null||m.length===0||r&&!g)r?h(null):c();else{let S=r?0:n,v=S*4,y=p.clippingState||null;l.value=y,y=h(m,u,v,d);for(let U=0;U!==v;++U)y[U]=e[U];p.clippingState=y,this.numIntersection=_?this.numPlanes:0,this.numPlanes+=S}};function c(){l.value!==e&&(l.value=e,l.needsUpdate=n>0),t.numPlanes=n,t.numIntersection=0}function h(f,u,d,m){let _=f!==null?f.length:0,g=null;if(_!==0){if(g=l.value,m!==!0||g===null){let p=d+_*4,S=u.matrixWorldInverse;a.getNormalMatrix(S),(g===null||g.length<p)&&(g=new Float32Array(p));for(let v=0,y=d;v!==_;++v,y+=4)o.copy(f[v]).applyMatrix4(S,a),o.normal.toArray(g,y),g[y+3]=o.constant}l.value=g,l.needsUpdate=!0}return t.numPlanes=_,t.numIntersection=0,g}}function zM(i){let t=new WeakMap;function e(o,a){return a===Bh?o.mapping=Zr:a===zh&&(o.mapping=Jr),o}function n(o){if(o&&o.isTexture){let a=o.mapping;if(a===Bh||a===zh)if(t.has(o)){let l=t.get(o).texture;return e(l,o.mapping)}else{let l=o.image;if(l&&l.height>0){let c=new vu(l.height);return c.fromEquirectangularTexture(i,o),t.set(o,c),o.addEventListener("dispose",s),e(c.texture,o.mapping)}else return null}}return o}function s(o){let a=o.target;a.removeEventListener("dispose",s);let l=t.get(a);l!==void 0&&(t.delete(a),l.dispose())}function r(){t=new WeakMap}return{get:n,dispose:r}}var eo=class extends hl{constructor(t=-1,e=1,n=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=t,this.right=e,this.top=n,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.left=t.left,this.right=t.right,this.top=t.top,this.bottom=t.bottom,this.near=t.near,this.far=t.far,this.zoom=t.zoom,this.view=t.view===null?null:Object.assign({},t.view),this}setViewOffset(t,e,n,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=(this.right-this.left)/(2*this.zoom),e=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=n-t,o=n+t,a=s+e,l=s-e;if(this.view!==null&&this.view.enabled){let c=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,o=r+c*this.view.width,a-=h*this.view.offsetY,l=a-h*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,l,this.near,this.far,this.coordinateSystem),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.zoom=this.zoom,e.object.left=this.left,e.object.right=this.right,e.object.top=this.top,e.object.bottom=this.bottom,e.object.near=this.near,e.object.far=this.far,this.view!==null&&(e.object.view=Object.assign({},this.view)),e}},Vr=4,_p=[.125,.215,.35,.446,.526,.582],js=20,_h=new eo,xp=new oe,xh=null,yh=0,vh=0,Mh=!1,Js=(1+Math.sqrt(5))/2,kr=1/Js,yp=[new D(-Js,kr,0),new D(Js,kr,0),new D(-kr,0,Js),new D(kr,0,Js),new D(0,Js,-kr),new D(0,Js,kr),new D(-1,1,-1),new D(1,1,-1),new D(-1,1,1),new D(1,1,1)],fl=class{constructor(t){this._renderer=t,this._pingPongRenderTarget=null,this._lodMax=0,this._cubeSize=0,this._lodPlanes=[],this._sizeLods=[],this._sigmas=[],this._blurMaterial=null,this._cubemapMaterial=null,this._equirectMaterial=null,this._compileMaterial(this._blurMaterial)}fromScene(t,e=0,n=.1,s=100){xh=this._renderer.getRenderTarget(),yh=this._renderer.getActiveCubeFace(),vh=this._renderer.getActiveMipmapLevel(),Mh=this._renderer.xr.enabled,this._renderer.xr.enabled=!1,this._setSize(256);let r=this._allocateTargets();return r.depthBuffer=!0,this._sceneToCubeUV(t,n,s,r),e>0&&this._blur(r,0,0,e),this._applyPMREM(r),this._cleanup(r),r}fromEquirectangular(t,e=null){return this._fromTexture(t,e)}fromCubemap(t,e=null){return this._fromTexture(t,e)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=bp(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=Mp(),this._compileMaterial(this._equirectMaterial))}dispose(){this._dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose()}_setSize(t){this._lodMax=Math.floor(Math.log2(t)),this._cubeSize=Math.pow(2,this._lodMax)}_dispose(){this._blurMaterial!==null&&this._blurMaterial.dispose(),this._pingPongRenderTarget!==null&&this._pingPongRenderTarget.dispose();for(let t=0;t<this._lodPlanes.length;t++)this._lodPlanes[t].dispose()}_cleanup(t){this._renderer.setRenderTarget(xh,yh,vh),this._renderer.xr.enabled=Mh,t.scissorTest=!1,ka(t,0,0,t.width,t.height)}_fromTexture(t,e){t.mapping===Zr||t.mapping===Jr?this._setSize(t.image.length===0?16:t.image[0].width||t.image[0].image.width):this._setSize(t.image.width/4),xh=this._renderer.getRenderTarget(),yh=this._renderer.getActiveCubeFace(),vh=this._renderer.getActiveMipmapLevel(),Mh=this._renderer.xr.enabled,this._renderer.xr.enabled=!1;let n=e||this._allocateTargets();return this._textureToCubeUV(t,n),this._applyPMREM(n),this._cleanup(n),n}_allocateTargets(){let t=3*Math.max(this._cubeSize,112),e=4*this._cubeSize,n={magFilter:Oi,minFilter:Oi,generateMipmaps:!1,type:Yo,format:Mi,colorSpace:ro,depthBuffer:!1},s=vp(t,e,n);if(this._pingPongRenderTarget===null||this._pingPongRenderTarget.width!==t||this._pingPongRenderTarget.height!==e){this._pingPongRenderTarget!==null&&this._dispose(),this._pingPongRenderTarget=vp(t,e,n);let{_lodMax:r}=this;({sizeLods:this._sizeLods,lodPlanes:this._lodPlanes,sigmas:this._sigmas}=kM(r)),this._blurMaterial=VM(r,t,e)}return s}_compileMaterial(t){let e=new xe(this._lodPlanes[0],t);this._renderer.compile(e,_h)}_sceneToCubeUV(t,e,n,s){let a=new Un(90,1,e,n),l=[1,-1,1,1,1,1],c=[1,1,1,-1,-1,-1],h=this._renderer,f=h.autoClear,u=h.toneMapping;h.getClearColor(xp),h.toneMapping=Ps,h.autoClear=!1;let d=new us({name:"PMREM.Background",side:zn,depthWrite:!1,depthTest:!1}),m=new xe(new Vi,d),_=!1,g=t.background;g?g.isColor&&(d.color.copy(g),t.background=null,_=!0):(d.color.copy(xp),_=!0);for(let p=0;p<6;p++){let S=p%3;S===0?(a.up.set(0,l[p],0),a.lookAt(c[p],0,0)):S===1?(a.up.set(0,0,l[p]),a.lookAt(0,c[p],0)):(a.up.set(0,l[p],0),a.lookAt(0,0,c[p]));let v=this._cubeSize;ka(s,S*v,p>2?v:0,v,v),h.setRenderTarget(s),_&&h.render(m,a),h.render(t,a)}m.geometry.dispose(),m.material.dispose(),h.toneMapping=u,h.autoClear=f,t.background=g}_textureToCubeUV(t,e){let n=this._renderer,s=t.mapping===Zr||t.mapping===Jr;s?(this._cubemapMaterial===null&&(this._cubemapMaterial=bp()),this._cubemapMaterial.uniforms.flipEnvMap.value=t.isRenderTargetTexture===!1?-1:1):this._equirectMaterial===null&&(this._equirectMaterial=Mp());let r=s?this._cubemapMaterial:this._equirectMaterial,o=new xe(this._lodPlanes[0],r),a=r.uniforms;a.envMap.value=t;let l=this._cubeSize;ka(e,0,0,3*l,2*l),n.setRenderTarget(e),n.render(o,_h)}_applyPMREM(t){let e=this._renderer,n=e.autoClear;e.autoClear=!1;let s=this._lodPlanes.length;for(let r=1;r<s;r++){let o=Math.sqrt(this._sigmas[r]*this._sigmas[r]-this._sigmas[r-1]*this._sigmas[r-1]),a=yp[(s-r-1)%yp.length];this._blur(t,r-1,r,o,a)}e.autoClear=n}_blur(t,e,n,s,r){let o=this._pingPongRenderTarget;this._halfBlur(t,o,e,n,s,"latitudinal",r),this._halfBlur(o,t,n,n,s,"longitudinal",r)}_halfBlur(t,e,n,s,r,o,a){let l=this._renderer,c=this._blurMaterial;o!=="latitudinal"&&o!=="longitudinal"&&console.error("blur direction must be either latitudinal or longitudinal!");let h=3,f=new xe(this._lodPlanes[s],c),u=c.uniforms,d=this._sizeLods[n]-1,m=isFinite(r)?Math.PI/(2*d):2*Math.PI/(2*js-1),_=r/m,g=isFinite(r)?1+Math.floor(h*_):js;g>js&&console.warn(`sigmaRadians, ${r}, is too large and will clip, as it requested ${g} samples when the maximum is set to ${js}`);let p=[],S=0;for(let P=0;P<js;++P){let F=P/_,E=Math.exp(-F*F/2);p.push(E),P===0?S+=E:P<g&&(S+=2*E)}for(let P=0;P<p.length;P++)p[P]=p[P]/S;u.envMap.value=t.texture,u.samples.value=g,u.weights.value=p,u.latitudinal.value=o==="latitudinal",a&&(u.poleAxis.value=a);let{_lodMax:v}=this;u.dTheta.value=m,u.mipInt.value=v-n;let y=this._sizeLods[s],U=3*y*(s>v-Vr?s-v+Vr:0),R=4*(this._cubeSize-y);ka(e,U,R,3*y,2*y),l.setRenderTarget(e),l.render(f,_h)}};function kM(i){let t=[],e=[],n=[],s=i,r=i-Vr+1+_p.length;for(let o=0;o<r;o++){let a=Math.pow(2,s);e.push(a);let l=1/a;o>i-Vr?l=_p[o-i+Vr-1]:o===0&&(l=0),n.push(l);let c=1/(a-2),h=-c,f=1+c,u=[h,h,f,h,f,f,h,h,f,f,h,f],d=6,m=6,_=3,g=2,p=1,S=new Float32Array(_*m*d),v=new Float32Array(g*m*d),y=new Float32Array(p*m*d);for(let R=0;R<d;R++){let P=R%3*2/3-1,F=R>2?0:-1,E=[P,F,0,P+2/3,F,0,P+2/3,F+1,0,P,F,0,P+2/3,F+1,0,P,F+1,0];S.set(E,_*m*R),v.set(u,g*m*R);let M=[R,R,R,R,R,R];y.set(M,p*m*R)}let U=new ve;U.setAttribute("position",new $n(S,_)),U.setAttribute("uv",new $n(v,g)),U.setAttribute("faceIndex",new $n(y,p)),t.push(U),s>Vr&&s--}return{lodPlanes:t,sizeLods:e,sigmas:n}}function vp(i,t,e){let n=new hs(i,t,e);return n.texture.mapping=zl,n.texture.name="PMREM.cubeUv",n.scissorTest=!0,n}function ka(i,t,e,n,s){i.viewport.set(t,e,n,s),i.scissor.set(t,e,n,s)}function VM(i,t,e){let n=new Float32Array(js),s=new D(0,1,0);return new ai({name:"SphericalGaussianBlur",defines:{n:js,CUBEUV_TEXEL_WIDTH:1/t,CUBEUV_TEXEL_HEIGHT:1/e,CUBEUV_MAX_MIP:`${i}.0`},uniforms:{envMap:{value:null},samples:{value:1},weights:{value:n},latitudinal:{value:!1},dTheta:{value:0},mipInt:{value:0},poleAxis:{value:s}},vertexShader:ff(),fragmentShader:`

			precision mediump float;
			precision mediump int;

			varying vec3 vOutputDirection;

			uniform sampler2D envMap;
			uniform int samples;
			uniform float weights[ n ];
			uniform bool latitudinal;
			uniform float dTheta;
			uniform float mipInt;
			uniform vec3 poleAxis;

			#define ENVMAP_TYPE_CUBE_UV
			#include <cube_uv_reflection_fragment>

			vec3 getSample( float theta, vec3 axis ) {

				float cosTheta = cos( theta );
				// Rodrigues' axis-angle rotation
				vec3 sampleDirection = vOutputDirection * cosTheta
					+ cross( axis, vOutputDirection ) * sin( theta )
					+ axis * dot( axis, vOutputDirection ) * ( 1.0 - cosTheta );

				return bilinearCubeUV( envMap, sampleDirection, mipInt );

			}

			void main() {

				vec3 axis = latitudinal ? poleAxis : cross( poleAxis, vOutputDirection );

				if ( all( equal( axis, vec3( 0.0 ) ) ) ) {

					axis = vec3( vOutputDirection.z, 0.0, - vOutputDirection.x );

				}

				axis = normalize( axis );

				gl_FragColor = vec4( 0.0, 0.0, 0.0, 1.0 );
				gl_FragColor.rgb += weights[ 0 ] * getSample( 0.0, axis );

				for ( int i = 1; i < n; i++ ) {

					if ( i >= samples ) {

						break;

					}

					float theta = dTheta * float( i );
					gl_FragColor.rgb += weights[ i ] * getSample( -1.0 * theta, axis );
					gl_FragColor.rgb += weights[ i ] * getSample( theta, axis );

				}

			}
		`,blending:Rs,depthTest:!1,depthWrite:!1})}function Mp(){return new ai({name:"EquirectangularToCubeUV",uniforms:{envMap:{value:null}},vertexShader:ff(),fragmentShader:`

			precision mediump float;
			precision mediump int;

			varying vec3 vOutputDirection;

			uniform sampler2D envMap;

			#include <common>

			void main() {

				vec3 outputDirection = normalize( vOutputDirection );
				vec2 uv = equirectUv( outputDirection );

				gl_FragColor = vec4( texture2D ( envMap, uv ).rgb, 1.0 );

			}
		`,blending:Rs,depthTest:!1,depthWrite:!1})}function bp(){return new ai({name:"CubemapToCubeUV",uniforms:{envMap:{value:null},flipEnvMap:{value:-1}},vertexShader:ff(),fragmentShader:`

			precision mediump float;
			precision mediump int;

			uniform float flipEnvMap;

			varying vec3 vOutputDirection;

			uniform samplerCube envMap;

			void main() {

				gl_FragColor = textureCube( envMap, vec3( flipEnvMap * vOutputDirection.x, vOutputDirection.yz ) );

			}
		`,blending:Rs,depthTest:!1,depthWrite:!1})}function ff(){return`

		precision mediump float;
		precision mediump int;

		attribute float faceIndex;

		varying vec3 vOutputDirection;

		// RH coordinate system; PMREM face-indexing convention
		vec3 getDirection( vec2 uv, float face ) {

			uv = 2.0 * uv - 1.0;

			vec3 direction = vec3( uv, 1.0 );

			if ( face == 0.0 ) {

				direction = direction.zyx; // ( 1, v, u ) pos x

			} else if ( face == 1.0 ) {

				direction = direction.xzy;
				direction.xz *= -1.0; // ( -u, 1, -v ) pos y

			} else if ( face == 2.0 ) {

				direction.x *= -1.0; // ( -u, v, 1 ) pos z

			} else if ( face == 3.0 ) {

				direction = direction.zyx;
				direction.xz *= -1.0; // ( -1, v, -u ) neg x

			} else if ( face == 4.0 ) {

				direction = direction.xzy;
				direction.xy *= -1.0; // ( -u, -1, v ) neg y

			} else if ( face == 5.0 ) {

				direction.z *= -1.0; // ( u, v, -1 ) neg z

			}

			return direction;

		}

		void main() {

			vOutputDirection = getDirection( uv, faceIndex );
			gl_Position = vec4( position, 1.0 );

		}
	`}function HM(i){let t=new WeakMap,e=null;function n(a){if(a&&a.isTexture){let l=a.mapping,c=l===Bh||l===zh,h=l===Zr||l===Jr;if(c||h){let f=t.get(a),u=f!==void 0?f.texture.pmremVersion:0;if(a.isRenderTargetTexture&&a.pmremVersion!==u)return e===null&&(e=new fl(i)),f=c?e.fromEquirectangular(a,f):e.fromCubemap(a,f),f.texture.pmremVersion=a.pmremVersion,t.set(a,f),f.texture;if(f!==void 0)return f.texture;{let d=a.image;return c&&d&&d.height>0||h&&d&&s(d)?(e===null&&(e=new fl(i)),f=c?e.fromEquirectangular(a):e.fromCubemap(a),f.texture.pmremVersion=a.pmremVersion,t.set(a,f),a.addEventListener("dispose",r),f.texture):null}}}return a}function s(a){let l=0,c=6;for(let h=0;h<c;h++)a[h]!==void 0&&l++;return l===c}function r(a){let l=a.target;l.removeEventListener("dispose",r);let c=t.get(l);c!==void 0&&(t.delete(l),c.dispose())}function o(){t=new WeakMap,e!==null&&(e.dispose(),e=null)}return{get:n,dispose:o}}function GM(i){let t={};function e(n){if(t[n]!==void 0)return t[n];let s;switch(n){case"WEBGL_depth_texture":s=i.getExtension("WEBGL_depth_texture")||i.getExtension("MOZ_WEBGL_depth_texture")||i.getExtension("WEBKIT_WEBGL_depth_texture");break;case"EXT_texture_filter_anisotropic":s=i.getExtension("EXT_texture_filter_anisotropic")||i.getExtension("MOZ_EXT_texture_filter_anisotropic")||i.getExtension("WEBKIT_EXT_texture_filter_anisotropic");break;case"WEBGL_compressed_texture_s3tc":s=i.getExtension("WEBGL_compressed_texture_s3tc")||i.getExtension("MOZ_WEBGL_compressed_texture_s3tc")||i.getExtension("WEBKIT_WEBGL_compressed_texture_s3tc");break;case"WEBGL_compressed_texture_pvrtc":s=i.getExtension("WEBGL_compressed_texture_pvrtc")||i.getExtension("WEBKIT_WEBGL_compressed_texture_pvrtc");break;default:s=i.getExtension(n)}return t[n]=s,s}return{has:function(n){return e(n)!==null},init:function(){e("EXT_color_buffer_float"),e("WEBGL_clip_cull_distance"),e("OES_texture_float_linear"),e("EXT_color_buffer_half_float"),e("WEBGL_multisampled_render_to_texture"),e("WEBGL_render_shared_exponent")},get:function(n){let s=e(n);return s===null&&Lo("THREE.WebGLRenderer: "+n+" extension not supported."),s}}}function WM(i,t,e,n){let s={},r=new WeakMap;function o(f){let u=f.target;u.index!==null&&t.remove(u.index);for(let m in u.attributes)t.remove(u.attributes[m]);for(let m in u.morphAttributes){let _=u.morphAttributes[m];for(let g=0,p=_.length;g<p;g++)t.remove(_[g])}u.removeEventListener("dispose",o),delete s[u.id];let d=r.get(u);d&&(t.remove(d),r.delete(u)),n.releaseStatesOfGeometry(u),u.isInstancedBufferGeometry===!0&&delete u._maxInstanceCount,e.memory.geometries--}function a(f,u){return s[u.id]===!0||(u.addEventListener("dispose",o),s[u.id]=!0,e.memory.geometries++),u}function l(f){let u=f.attributes;for(let m in u)t.update(u[m],i.ARRAY_BUFFER);let d=f.morphAttributes;for(let m in d){let _=d[m];for(let g=0,p=_.length;g<p;g++)t.update(_[g],i.ARRAY_BUFFER)}}function c(f){let u=[],d=f.index,m=f.attributes.position,_=0;if(d!==null){let S=d.array;_=d.version;for(let v=0,y=S.length;v<y;v+=3){let U=S[v+0],R=S[v+1],P=S[v+2];u.push(U,R,R,P,P,U)}}else if(m!==void 0){let S=m.array;_=m.version;for(let v=0,y=S.length/3-1;v<y;v+=3){let U=v+0,R=v+1,P=v+2;u.push(U,R,R,P,P,U)}}else return;let g=new(_m(u)?cl:ll)(u,1);g.version=_;let p=r.get(f);p&&t.remove(p),r.set(f,g)}function h(f){let u=r.get(f);if(u){let d=f.index;d!==null&&u.version<d.version&&c(f)}else c(f);return r.get(f)}return{get:a,update:l,getWireframeAttribute:h}}function XM(i,t,e){let n;function s(u){n=u}let r,o;function a(u){r=u.type,o=u.bytesPerElement}function l(u,d){i.drawElements(n,d,r,u*o),e.update(d,n,1)}function c(u,d,m){m!==0&&(i.drawElementsInstanced(n,d,r,u*o,m),e.update(d,n,m))}function h(u,d,m){if(m===0)return;t.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,d,0,r,u,0,m);let g=0;for(let p=0;p<m;p++)g+=d[p];e.update(g,n,1)}function f(u,d,m,_){if(m===0)return;let g=t.get("WEBGL_multi_draw");if(g===null)for(let p=0;p<u.length;p++)c(u[p]/o,d[p],_[p]);else{g.multiDrawElementsInstancedWEBGL(n,d,0,r,u,0,_,0,m);let p=0;for(let S=0;S<m;S++)p+=d[S]*_[S];e.update(p,n,1)}}this.setMode=s,this.setIndex=a,this.render=l,this.renderInstances=c,this.renderMultiDraw=h,this.renderMultiDrawInstances=f}function qM(i){let t={geometries:0,textures:0},e={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,o,a){switch(e.calls++,o){case i.TRIANGLES:e.triangles+=a*(r/3);break;case i.LINES:e.lines+=a*(r/2);break;case i.LINE_STRIP:e.lines+=a*(r-1);break;case i.LINE_LOOP:e.lines+=a*r;break;case i.POINTS:e.points+=a*r;break;default:console.error("THREE.WebGLInfo: Unknown draw mode:",o);break}}function s(){e.calls=0,e.triangles=0,e.points=0,e.lines=0}return{memory:t,render:e,programs:null,autoReset:!0,reset:s,update:n}}function YM(i,t,e){let n=new WeakMap,s=new De;function r(o,a,l){let c=o.morphTargetInfluences,h=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,f=h!==void 0?h.length:0,u=n.get(a);if(u===void 0||u.count!==f){let E=function(){P.dispose(),n.delete(a),a.removeEventListener("dispose",E)};u!==void 0&&u.texture.dispose();let d=a.morphAttributes.position!==void 0,m=a.morphAttributes.normal!==void 0,_=a.morphAttributes.color!==void 0,g=a.morphAttributes.position||[],p=a.morphAttributes.normal||[],S=a.morphAttributes.color||[],v=0;d===!0&&(v=1),m===!0&&(v=2),_===!0&&(v=3);let y=a.attributes.position.count*v,U=1;y>t.maxTextureSize&&(U=Math.ceil(y/t.maxTextureSize),y=t.maxTextureSize);let R=new Float32Array(y*U*4*f),P=new al(R,y,U,f);P.type=rs,P.needsUpdate=!0;let F=v*4;for(let M=0;M<f;M++){let A=g[M],W=p[M],G=S[M],X=y*U*4*M;for(let Z=0;Z<A.count;Z++){let Y=Z*F;d===!0&&(s.fromBufferAttribute(A,Z),R[X+Y+0]=s.x,R[X+Y+1]=s.y,R[X+Y+2]=s.z,R[X+Y+3]=0),m===!0&&(s.fromBufferAttribute(W,Z),R[X+Y+4]=s.x,R[X+Y+5]=s.y,R[X+Y+6]=s.z,R[X+Y+7]=0),_===!0&&(s.fromBufferAttribute(G,Z),R[X+Y+8]=s.x,R[X+Y+9]=s.y,R[X+Y+10]=s.z,R[X+Y+11]=G.itemSize===4?s.w:1)}}u={count:f,texture:P,size:new gt(y,U)},n.set(a,u),a.addEventListener("dispose",E)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)l.getUniforms().setValue(i,"morphTexture",o.morphTexture,e);else{let d=0;for(let _=0;_<c.length;_++)d+=c[_];let m=a.morphTargetsRelative?1:1-d;l.getUniforms().setValue(i,"morphTargetBaseInfluence",m),l.getUniforms().setValue(i,"morphTargetInfluences",c)}l.getUniforms().setValue(i,"morphTargetsTexture",u.texture,e),l.getUniforms().setValue(i,"morphTargetsTextureSize",u.size)}return{update:r}}function $M(i,t,e,n){let s=new WeakMap;function r(l){let c=n.render.frame,h=l.geometry,f=t.get(l,h);if(s.get(f)!==c&&(t.update(f),s.set(f,c)),l.isInstancedMesh&&(l.hasEventListener("dispose",a)===!1&&l.addEventListener("dispose",a),s.get(l)!==c&&(e.update(l.instanceMatrix,i.ARRAY_BUFFER),l.instanceColor!==null&&e.update(l.instanceColor,i.ARRAY_BUFFER),s.set(l,c))),l.isSkinnedMesh){let u=l.skeleton;s.get(u)!==c&&(u.update(),s.set(u,c))}return f}function o(){s=new WeakMap}function a(l){let c=l.target;c.removeEventListener("dispose",a),e.remove(c.instanceMatrix),c.instanceColor!==null&&e.remove(c.instanceColor)}return{update:r,dispose:o}}var dl=class extends oi{constructor(t,e,n,s,r,o,a,l,c,h=Wr){if(h!==Wr&&h!==jr)throw new Error("DepthTexture format must be either THREE.DepthFormat or THREE.DepthStencilFormat");n===void 0&&h===Wr&&(n=er),n===void 0&&h===jr&&(n=Kr),super(null,s,r,o,a,l,h,n,c),this.isDepthTexture=!0,this.image={width:t,height:e},this.magFilter=a!==void 0?a:bi,this.minFilter=l!==void 0?l:bi,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(t){return super.copy(t),this.compareFunction=t.compareFunction,this}toJSON(t){let e=super.toJSON(t);return this.compareFunction!==null&&(e.compareFunction=this.compareFunction),e}},Mm=new oi,Sp=new dl(1,1),bm=new al,Sm=new xu,wm=new ul,wp=[],Ep=[],Tp=new Float32Array(16),Ap=new Float32Array(9),Cp=new Float32Array(4);function oo(i,t,e){let n=i[0];if(n<=0||n>0)return i;let s=t*e,r=wp[s];if(r===void 0&&(r=new Float32Array(s),wp[s]=r),t!==0){n.toArray(r,0);for(let o=1,a=0;o!==t;++o)a+=e,i[o].toArray(r,a)}return r}function sn(i,t){if(i.length!==t.length)return!1;for(let e=0,n=i.length;e<n;e++)if(i[e]!==t[e])return!1;return!0}function rn(i,t){for(let e=0,n=t.length;e<n;e++)i[e]=t[e]}function Gl(i,t){let e=Ep[t];e===void 0&&(e=new Int32Array(t),Ep[t]=e);for(let n=0;n!==t;++n)e[n]=i.allocateTextureUnit();return e}function ZM(i,t){let e=this.cache;e[0]!==t&&(i.uniform1f(this.addr,t),e[0]=t)}function JM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2f(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(sn(e,t))return;i.uniform2fv(this.addr,t),rn(e,t)}}function KM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3f(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else if(t.r!==void 0)(e[0]!==t.r||e[1]!==t.g||e[2]!==t.b)&&(i.uniform3f(this.addr,t.r,t.g,t.b),e[0]=t.r,e[1]=t.g,e[2]=t.b);else{if(sn(e,t))return;i.uniform3fv(this.addr,t),rn(e,t)}}function jM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4f(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(sn(e,t))return;i.uniform4fv(this.addr,t),rn(e,t)}}function QM(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(sn(e,t))return;i.uniformMatrix2fv(this.addr,!1,t),rn(e,t)}else{if(sn(e,n))return;Cp.set(n),i.uniformMatrix2fv(this.addr,!1,Cp),rn(e,n)}}function tb(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(sn(e,t))return;i.uniformMatrix3fv(this.addr,!1,t),rn(e,t)}else{if(sn(e,n))return;Ap.set(n),i.uniformMatrix3fv(this.addr,!1,Ap),rn(e,n)}}function eb(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(sn(e,t))return;i.uniformMatrix4fv(this.addr,!1,t),rn(e,t)}else{if(sn(e,n))return;Tp.set(n),i.uniformMatrix4fv(this.addr,!1,Tp),rn(e,n)}}function nb(i,t){let e=this.cache;e[0]!==t&&(i.uniform1i(this.addr,t),e[0]=t)}function ib(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2i(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(sn(e,t))return;i.uniform2iv(this.addr,t),rn(e,t)}}function sb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3i(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(sn(e,t))return;i.uniform3iv(this.addr,t),rn(e,t)}}function rb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4i(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(sn(e,t))return;i.uniform4iv(this.addr,t),rn(e,t)}}function ob(i,t){let e=this.cache;e[0]!==t&&(i.uniform1ui(this.addr,t),e[0]=t)}function ab(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2ui(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(sn(e,t))return;i.uniform2uiv(this.addr,t),rn(e,t)}}function lb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3ui(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(sn(e,t))return;i.uniform3uiv(this.addr,t),rn(e,t)}}function cb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4ui(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(sn(e,t))return;i.uniform4uiv(this.addr,t),rn(e,t)}}function hb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_2D_SHADOW?(Sp.compareFunction=gm,r=Sp):r=Mm,e.setTexture2D(t||r,s)}function ub(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture3D(t||Sm,s)}function fb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTextureCube(t||wm,s)}function db(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture2DArray(t||bm,s)}function pb(i){switch(i){case 5126:return ZM;case 35664:return JM;case 35665:return KM;case 35666:return jM;case 35674:return QM;case 35675:return tb;case 35676:return eb;case 5124:case 35670:return nb;case 35667:case 35671:return ib;case 35668:case 35672:return sb;case 35669:case 35673:return rb;case 5125:return ob;case 36294:return ab;case 36295:return lb;case 36296:return cb;case 35678:case 36198:case 36298:case 36306:case 35682:return hb;case 35679:case 36299:case 36307:return ub;case 35680:case 36300:case 36308:case 36293:return fb;case 36289:case 36303:case 36311:case 36292:return db}}function mb(i,t){i.uniform1fv(this.addr,t)}function gb(i,t){let e=oo(t,this.size,2);i.uniform2fv(this.addr,e)}function _b(i,t){let e=oo(t,this.size,3);i.uniform3fv(this.addr,e)}function xb(i,t){let e=oo(t,this.size,4);i.uniform4fv(this.addr,e)}function yb(i,t){let e=oo(t,this.size,4);i.uniformMatrix2fv(this.addr,!1,e)}function vb(i,t){let e=oo(t,this.size,9);i.uniformMatrix3fv(this.addr,!1,e)}function Mb(i,t){let e=oo(t,this.size,16);i.uniformMatrix4fv(this.addr,!1,e)}function bb(i,t){i.uniform1iv(this.addr,t)}function Sb(i,t){i.uniform2iv(this.addr,t)}function wb(i,t){i.uniform3iv(this.addr,t)}function Eb(i,t){i.uniform4iv(this.addr,t)}function Tb(i,t){i.uniform1uiv(this.addr,t)}function Ab(i,t){i.uniform2uiv(this.addr,t)}function Cb(i,t){i.uniform3uiv(this.addr,t)}function Rb(i,t){i.uniform4uiv(this.addr,t)}function Pb(i,t,e){let n=this.cache,s=t.length,r=Gl(e,s);sn(n,r)||(i.uniform1iv(this.addr,r),rn(n,r));for(let o=0;o!==s;++o)e.setTexture2D(t[o]||Mm,r[o])}function Ib(i,t,e){let n=this.cache,s=t.length,r=Gl(e,s);sn(n,r)||(i.uniform1iv(this.addr,r),rn(n,r));for(let o=0;o!==s;++o)e.setTexture3D(t[o]||Sm,r[o])}function Lb(i,t,e){let n=this.cache,s=t.length,r=Gl(e,s);sn(n,r)||(i.uniform1iv(this.addr,r),rn(n,r));for(let o=0;o!==s;++o)e.setTextureCube(t[o]||wm,r[o])}function Db(i,t,e){let n=this.cache,s=t.length,r=Gl(e,s);sn(n,r)||(i.uniform1iv(this.addr,r),rn(n,r));for(let o=0;o!==s;++o)e.setTexture2DArray(t[o]||bm,r[o])}function Ub(i){switch(i){case 5126:return mb;case 35664:return gb;case 35665:return _b;case 35666:return xb;case 35674:return yb;case 35675:return vb;case 35676:return Mb;case 5124:case 35670:return bb;case 35667:case 35671:return Sb;case 35668:case 35672:return wb;case 35669:case 35673:return Eb;case 5125:return Tb;case 36294:return Ab;case 36295:return Cb;case 36296:return Rb;case 35678:case 36198:case 36298:case 36306:case 35682:return Pb;case 35679:case 36299:case 36307:return Ib;case 35680:case 36300:case 36308:case 36293:return Lb;case 36289:case 36303:case 36311:case 36292:return Db}}var Mu=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.setValue=pb(e.type)}},bu=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.size=e.size,this.setValue=Ub(e.type)}},Su=class{constructor(t){this.id=t,this.seq=[],this.map={}}setValue(t,e,n){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(t,e[a.id],n)}}},bh=/(\w+)(\])?(\[|\.)?/g;function Rp(i,t){i.seq.push(t),i.map[t.id]=t}function Nb(i,t,e){let n=i.name,s=n.length;for(bh.lastIndex=0;;){let r=bh.exec(n),o=bh.lastIndex,a=r[1],l=r[2]==="]",c=r[3];if(l&&(a=a|0),c===void 0||c==="["&&o+2===s){Rp(e,c===void 0?new Mu(a,i,t):new bu(a,i,t));break}else{let f=e.map[a];f===void 0&&(f=new Su(a),Rp(e,f)),e=f}}}var Yr=class{constructor(t,e){this.seq=[],this.map={};let n=t.getProgramParameter(e,t.ACTIVE_UNIFORMS);for(let s=0;s<n;++s){let r=t.getActiveUniform(e,s),o=t.getUniformLocation(e,r.name);Nb(r,o,this)}}setValue(t,e,n,s){let r=this.map[e];r!==void 0&&r.setValue(t,n,s)}setOptional(t,e,n){let s=e[n];s!==void 0&&this.setValue(t,n,s)}static upload(t,e,n,s){for(let r=0,o=e.length;r!==o;++r){let a=e[r],l=n[a.id];l.needsUpdate!==!1&&a.setValue(t,l.value,s)}}static seqWithValue(t,e){let n=[];for(let s=0,r=t.length;s!==r;++s){let o=t[s];o.id in e&&n.push(o)}return n}};function Pp(i,t,e){let n=i.createShader(t);return i.shaderSource(n,e),i.compileShader(n),n}var Fb=37297,Ob=0;function Bb(i,t){let e=i.split(`
`),n=[],s=Math.max(t-6,0),r=Math.min(t+6,e.length);for(let o=s;o<r;o++){let a=o+1;n.push(`${a===t?">":" "} ${a}: ${e[o]}`)}return n.join(`
`)}var Ip=new le;function zb(i){be._getMatrix(Ip,be.workingColorSpace,i);let t=`mat3( ${Ip.elements.map(e=>e.toFixed(4))} )`;switch(be.getTransfer(i)){case kl:return[t,"LinearTransferOETF"];case Le:return[t,"sRGBTransferOETF"];default:return console.warn("THREE.WebGLProgram: Unsupported color space: ",i),[t,"LinearTransferOETF"]}}function Lp(i,t,e){let n=i.getShaderParameter(t,i.COMPILE_STATUS),s=i.getShaderInfoLog(t).trim();if(n&&s==="")return"";let r=/ERROR: 0:(\d+)/.exec(s);if(r){let o=parseInt(r[1]);return e.toUpperCase()+`

`+s+`

`+Bb(i.getShaderSource(t),o)}else return s}function kb(i,t){let e=zb(t);return[`vec4 ${i}( vec4 value ) {`,`	return ${e[1]}( vec4( value.rgb * ${e[0]}, value.a ) );`,"}"].join(`
`)}function Vb(i,t){let e;switch(t){case j_:e="Linear";break;case Q_:e="Reinhard";break;case tx:e="Cineon";break;case ex:e="ACESFilmic";break;case ix:e="AgX";break;case sx:e="Neutral";break;case nx:e="Custom";break;default:console.warn("THREE.WebGLProgram: Unsupported toneMapping:",t),e="Linear"}return"vec3 "+i+"( vec3 color ) { return "+e+"ToneMapping( color ); }"}var Va=new D;function Hb(){be.getLuminanceCoefficients(Va);let i=Va.x.toFixed(4),t=Va.y.toFixed(4),e=Va.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${i}, ${t}, ${e} );`,"	return dot( weights, rgb );","}"].join(`
`)}function Gb(i){return[i.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",i.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(Do).join(`
`)}function Wb(i){let t=[];for(let e in i){let n=i[e];n!==!1&&t.push("#define "+e+" "+n)}return t.join(`
`)}function Xb(i,t){let e={},n=i.getProgramParameter(t,i.ACTIVE_ATTRIBUTES);for(let s=0;s<n;s++){let r=i.getActiveAttrib(t,s),o=r.name,a=1;r.type===i.FLOAT_MAT2&&(a=2),r.type===i.FLOAT_MAT3&&(a=3),r.type===i.FLOAT_MAT4&&(a=4),e[o]={type:r.type,location:i.getAttribLocation(t,o),locationSize:a}}return e}function Do(i){return i!==""}function Dp(i,t){let e=t.numSpotLightShadows+t.numSpotLightMaps-t.numSpotLightShadowsWithMaps;return i.replace(/NUM_DIR_LIGHTS/g,t.numDirLights).replace(/NUM_SPOT_LIGHTS/g,t.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,t.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,e).replace(/NUM_RECT_AREA_LIGHTS/g,t.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,t.numPointLights).replace(/NUM_HEMI_LIGHTS/g,t.numHemiLights).replace(/NUM_DIR_LIGHT_SHADOWS/g,t.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,t.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,t.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,t.numPointLightShadows)}function Up(i,t){return i.replace(/NUM_CLIPPING_PLANES/g,t.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,t.numClippingPlanes-t.numClipIntersection)}var qb=/^[ \t]*#include +<([\w\d./]+)>/gm;function wu(i){return i.replace(qb,$b)}var Yb=new Map;function $b(i,t){let e=he[t];if(e===void 0){let n=Yb.get(t);if(n!==void 0)e=he[n],console.warn('THREE.WebGLRenderer: Shader chunk "%s" has been deprecated. Use "%s" instead.',t,n);else throw new Error("Can not resolve #include <"+t+">")}return wu(e)}var Zb=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function Np(i){return i.replace(Zb,Jb)}function Jb(i,t,e,n){let s="";for(let r=parseInt(t);r<parseInt(e);r++)s+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function Fp(i){let t=`precision ${i.precision} float;
	precision ${i.precision} int;
	precision ${i.precision} sampler2D;
	precision ${i.precision} samplerCube;
	precision ${i.precision} sampler3D;
	precision ${i.precision} sampler2DArray;
	precision ${i.precision} sampler2DShadow;
	precision ${i.precision} samplerCubeShadow;
	precision ${i.precision} sampler2DArrayShadow;
	precision ${i.precision} isampler2D;
	precision ${i.precision} isampler3D;
	precision ${i.precision} isamplerCube;
	precision ${i.precision} isampler2DArray;
	precision ${i.precision} usampler2D;
	precision ${i.precision} usampler3D;
	precision ${i.precision} usamplerCube;
	precision ${i.precision} usampler2DArray;
	`;return i.precision==="highp"?t+=`
#define HIGH_PRECISION`:i.precision==="mediump"?t+=`
#define MEDIUM_PRECISION`:i.precision==="lowp"&&(t+=`
#define LOW_PRECISION`),t}function Kb(i){let t="SHADOWMAP_TYPE_BASIC";return i.shadowMapType===em?t="SHADOWMAP_TYPE_PCF":i.shadowMapType===I_?t="SHADOWMAP_TYPE_PCF_SOFT":i.shadowMapType===ss&&(t="SHADOWMAP_TYPE_VSM"),t}function jb(i){let t="ENVMAP_TYPE_CUBE";if(i.envMap)switch(i.envMapMode){case Zr:case Jr:t="ENVMAP_TYPE_CUBE";break;case zl:t="ENVMAP_TYPE_CUBE_UV";break}return t}function Qb(i){let t="ENVMAP_MODE_REFLECTION";if(i.envMap)switch(i.envMapMode){case Jr:t="ENVMAP_MODE_REFRACTION";break}return t}function tS(i){let t="ENVMAP_BLENDING_NONE";if(i.envMap)switch(i.combine){case sf:t="ENVMAP_BLENDING_MULTIPLY";break;case J_:t="ENVMAP_BLENDING_MIX";break;case K_:t="ENVMAP_BLENDING_ADD";break}return t}function eS(i){let t=i.envMapCubeUVHeight;if(t===null)return null;let e=Math.log2(t)-2,n=1/t;return{texelWidth:1/(3*Math.max(Math.pow(2,e),7*16)),texelHeight:n,maxMip:e}}function nS(i,t,e,n){let s=i.getContext(),r=e.defines,o=e.vertexShader,a=e.fragmentShader,l=Kb(e),c=jb(e),h=Qb(e),f=tS(e),u=eS(e),d=Gb(e),m=Wb(r),_=s.createProgram(),g,p,S=e.glslVersion?"#version "+e.glslVersion+`
`:"";e.isRawShaderMaterial?(g=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,m].filter(Do).join(`
`),g.length>0&&(g+=`
`),p=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,m].filter(Do).join(`
`),p.length>0&&(p+=`
`)):(g=[Fp(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,m,e.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",e.batching?"#define USE_BATCHING":"",e.batchingColor?"#define USE_BATCHING_COLOR":"",e.instancing?"#define USE_INSTANCING":"",e.instancingColor?"#define USE_INSTANCING_COLOR":"",e.instancingMorph?"#define USE_INSTANCING_MORPH":"",e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.map?"#define USE_MAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+h:"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.displacementMap?"#define USE_DISPLACEMENTMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.mapUv?"#define MAP_UV "+e.mapUv:"",e.alphaMapUv?"#define ALPHAMAP_UV "+e.alphaMapUv:"",e.lightMapUv?"#define LIGHTMAP_UV "+e.lightMapUv:"",e.aoMapUv?"#define AOMAP_UV "+e.aoMapUv:"",e.emissiveMapUv?"#define EMISSIVEMAP_UV "+e.emissiveMapUv:"",e.bumpMapUv?"#define BUMPMAP_UV "+e.bumpMapUv:"",e.normalMapUv?"#define NORMALMAP_UV "+e.normalMapUv:"",e.displacementMapUv?"#define DISPLACEMENTMAP_UV "+e.displacementMapUv:"",e.metalnessMapUv?"#define METALNESSMAP_UV "+e.metalnessMapUv:"",e.roughnessMapUv?"#define ROUGHNESSMAP_UV "+e.roughnessMapUv:"",e.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+e.anisotropyMapUv:"",e.clearcoatMapUv?"#define CLEARCOATMAP_UV "+e.clearcoatMapUv:"",e.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+e.clearcoatNormalMapUv:"",e.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+e.clearcoatRoughnessMapUv:"",e.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+e.iridescenceMapUv:"",e.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+e.iridescenceThicknessMapUv:"",e.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+e.sheenColorMapUv:"",e.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+e.sheenRoughnessMapUv:"",e.specularMapUv?"#define SPECULARMAP_UV "+e.specularMapUv:"",e.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+e.specularColorMapUv:"",e.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+e.specularIntensityMapUv:"",e.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+e.transmissionMapUv:"",e.thicknessMapUv?"#define THICKNESSMAP_UV "+e.thicknessMapUv:"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexColors?"#define USE_COLOR":"",e.vertexAlphas?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.flatShading?"#define FLAT_SHADED":"",e.skinning?"#define USE_SKINNING":"",e.morphTargets?"#define USE_MORPHTARGETS":"",e.morphNormals&&e.flatShading===!1?"#define USE_MORPHNORMALS":"",e.morphColors?"#define USE_MORPHCOLORS":"",e.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+e.morphTextureStride:"",e.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+e.morphTargetsCount:"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.sizeAttenuation?"#define USE_SIZEATTENUATION":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.logarithmicDepthBuffer?"#define USE_LOGDEPTHBUF":"",e.reverseDepthBuffer?"#define USE_REVERSEDEPTHBUF":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(Do).join(`
`),p=[Fp(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,m,e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",e.map?"#define USE_MAP":"",e.matcap?"#define USE_MATCAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+c:"",e.envMap?"#define "+h:"",e.envMap?"#define "+f:"",u?"#define CUBEUV_TEXEL_WIDTH "+u.texelWidth:"",u?"#define CUBEUV_TEXEL_HEIGHT "+u.texelHeight:"",u?"#define CUBEUV_MAX_MIP "+u.maxMip+".0":"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoat?"#define USE_CLEARCOAT":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.dispersion?"#define USE_DISPERSION":"",e.iridescence?"#define USE_IRIDESCENCE":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaTest?"#define USE_ALPHATEST":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.sheen?"#define USE_SHEEN":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexColors||e.instancingColor||e.batchingColor?"#define USE_COLOR":"",e.vertexAlphas?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.gradientMap?"#define USE_GRADIENTMAP":"",e.flatShading?"#define FLAT_SHADED":"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",e.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",e.logarithmicDepthBuffer?"#define USE_LOGDEPTHBUF":"",e.reverseDepthBuffer?"#define USE_REVERSEDEPTHBUF":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",e.toneMapping!==Ps?"#define TONE_MAPPING":"",e.toneMapping!==Ps?he.tonemapping_pars_fragment:"",e.toneMapping!==Ps?Vb("toneMapping",e.toneMapping):"",e.dithering?"#define DITHERING":"",e.opaque?"#define OPAQUE":"",he.colorspace_pars_fragment,kb("linearToOutputTexel",e.outputColorSpace),Hb(),e.useDepthPacking?"#define DEPTH_PACKING "+e.depthPacking:"",`
`].filter(Do).join(`
`)),o=wu(o),o=Dp(o,e),o=Up(o,e),a=wu(a),a=Dp(a,e),a=Up(a,e),o=Np(o),a=Np(a),e.isRawShaderMaterial!==!0&&(S=`#version 300 es
`,g=[d,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+g,p=["#define varying in",e.glslVersion===Zd?"":"layout(location = 0) out highp vec4 pc_fragColor;",e.glslVersion===Zd?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+p);let v=S+g+o,y=S+p+a,U=Pp(s,s.VERTEX_SHADER,v),R=Pp(s,s.FRAGMENT_SHADER,y);s.attachShader(_,U),s.attachShader(_,R),e.index0AttributeName!==void 0?s.bindAttribLocation(_,0,e.index0AttributeName):e.morphTargets===!0&&s.bindAttribLocation(_,0,"position"),s.linkProgram(_);function P(A){if(i.debug.checkShaderErrors){let W=s.getProgramInfoLog(_).trim(),G=s.getShaderInfoLog(U).trim(),X=s.getShaderInfoLog(R).trim(),Z=!0,Y=!0;if(s.getProgramParameter(_,s.LINK_STATUS)===!1)if(Z=!1,typeof i.debug.onShaderError=="function")i.debug.onShaderError(s,_,U,R);else{let nt=Lp(s,U,"vertex"),Q=Lp(s,R,"fragment");console.error("THREE.WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(_,s.VALIDATE_STATUS)+`

Material Name: `+A.name+`
Material Type: `+A.type+`

Program Info Log: `+W+`
`+nt+`
`+Q)}else W!==""?console.warn("THREE.WebGLProgram: Program Info Log:",W):(G===""||X==="")&&(Y=!1);Y&&(A.diagnostics={runnable:Z,programLog:W,vertexShader:{log:G,prefix:g},fragmentShader:{log:X,prefix:p}})}s.deleteShader(U),s.deleteShader(R),F=new Yr(s,_),E=Xb(s,_)}let F;this.getUniforms=function(){return F===void 0&&P(this),F};let E;this.getAttributes=function(){return E===void 0&&P(this),E};let M=e.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return M===!1&&(M=s.getProgramParameter(_,Fb)),M},this.destroy=function(){n.releaseStatesOfProgram(this),s.deleteProgram(_),this.program=void 0},this.type=e.shaderType,this.name=e.shaderName,this.id=Ob++,this.cacheKey=t,this.usedTimes=1,this.program=_,this.vertexShader=U,this.fragmentShader=R,this}var iS=0,Eu=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(t){let e=t.vertexShader,n=t.fragmentShader,s=this._getShaderStage(e),r=this._getShaderStage(n),o=this._getShaderCacheForMaterial(t);return o.has(s)===!1&&(o.add(s),s.usedTimes++),o.has(r)===!1&&(o.add(r),r.usedTimes++),this}remove(t){let e=this.materialCache.get(t);for(let n of e)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(t),this}getVertexShaderID(t){return this._getShaderStage(t.vertexShader).id}getFragmentShaderID(t){return this._getShaderStage(t.fragmentShader).id}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(t){let e=this.materialCache,n=e.get(t);return n===void 0&&(n=new Set,e.set(t,n)),n}_getShaderStage(t){let e=this.shaderCache,n=e.get(t);return n===void 0&&(n=new Tu(t),e.set(t,n)),n}},Tu=class{constructor(t){this.id=iS++,this.code=t,this.usedTimes=0}};function sS(i,t,e,n,s,r,o){let a=new ko,l=new Eu,c=new Set,h=[],f=s.logarithmicDepthBuffer,u=s.vertexTextures,d=s.precision,m={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distanceRGBA",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function _(E){return c.add(E),E===0?"uv":`uv${E}`}function g(E,M,A,W,G){let X=W.fog,Z=G.geometry,Y=E.isMeshStandardMaterial?W.environment:null,nt=(E.isMeshStandardMaterial?e:t).get(E.envMap||Y),Q=nt&&nt.mapping===zl?nt.image.height:null,dt=m[E.type];E.precision!==null&&(d=s.getMaxPrecision(E.precision),d!==E.precision&&console.warn("THREE.WebGLProgram.getParameters:",E.precision,"not supported, using",d,"instead."));let at=Z.morphAttributes.position||Z.morphAttributes.normal||Z.morphAttributes.color,_t=at!==void 0?at.length:0,pt=0;Z.morphAttributes.position!==void 0&&(pt=1),Z.morphAttributes.normal!==void 0&&(pt=2),Z.morphAttributes.color!==void 0&&(pt=3);let Zt,J,ht,Ot;if(dt){let fe=Nn[dt];Zt=fe.vertexShader,J=fe.fragmentShader}else Zt=E.vertexShader,J=E.fragmentShader,l.update(E),ht=l.getVertexShaderID(E),Ot=l.getFragmentShaderID(E);let lt=i.getRenderTarget(),Ft=i.state.buffers.depth.getReversed(),Yt=G.isInstancedMesh===!0,Ut=G.isBatchedMesh===!0,te=!!E.map,st=!!E.matcap,mt=!!nt,N=!!E.aoMap,Vt=!!E.lightMap,ut=!!E.bumpMap,Tt=!!E.normalMap,xt=!!E.displacementMap,Jt=!!E.emissiveMap,St=!!E.metalnessMap,C=!!E.roughnessMap,b=E.anisotropy>0,B=E.clearcoat>0,tt=E.dispersion>0,j=E.iridescence>0,et=E.sheen>0,Nt=E.transmission>0,Mt=b&&!!E.anisotropyMap,At=B&&!!E.clearcoatMap,Kt=B&&!!E.clearcoatNormalMap,ct=B&&!!E.clearcoatRoughnessMap,wt=j&&!!E.iridescenceMap,Xt=j&&!!E.iridescenceThicknessMap,$t=et&&!!E.sheenColorMap,Rt=et&&!!E.sheenRoughnessMap,ae=!!E.specularMap,ee=!!E.specularColorMap,we=!!E.specularIntensityMap,z=Nt&&!!E.transmissionMap,Et=Nt&&!!E.thicknessMap,it=!!E.gradientMap,ot=!!E.alphaMap,It=E.alphaTest>0,Pt=!!E.alphaHash,se=!!E.extensions,We=Ps;E.toneMapped&&(lt===null||lt.isXRRenderTarget===!0)&&(We=i.toneMapping);let Bt={shaderID:dt,shaderType:E.type,shaderName:E.name,vertexShader:Zt,fragmentShader:J,defines:E.defines,customVertexShaderID:ht,customFragmentShaderID:Ot,isRawShaderMaterial:E.isRawShaderMaterial===!0,glslVersion:E.glslVersion,precision:d,batching:Ut,batchingColor:Ut&&G._colorsTexture!==null,instancing:Yt,instancingColor:Yt&&G.instanceColor!==null,instancingMorph:Yt&&G.morphTexture!==null,supportsVertexTextures:u,outputColorSpace:lt===null?i.outputColorSpace:lt.isXRRenderTarget===!0?lt.texture.colorSpace:ro,alphaToCoverage:!!E.alphaToCoverage,map:te,matcap:st,envMap:mt,envMapMode:mt&&nt.mapping,envMapCubeUVHeight:Q,aoMap:N,lightMap:Vt,bumpMap:ut,normalMap:Tt,displacementMap:u&&xt,emissiveMap:Jt,normalMapObjectSpace:Tt&&E.normalMapType===lx,normalMapTangentSpace:Tt&&E.normalMapType===dm,metalnessMap:St,roughnessMap:C,anisotropy:b,anisotropyMap:Mt,clearcoat:B,clearcoatMap:At,clearcoatNormalMap:Kt,clearcoatRoughnessMap:ct,dispersion:tt,iridescence:j,iridescenceMap:wt,iridescenceThicknessMap:Xt,sheen:et,sheenColorMap:$t,sheenRoughnessMap:Rt,specularMap:ae,specularColorMap:ee,specularIntensityMap:we,transmission:Nt,transmissionMap:z,thicknessMap:Et,gradientMap:it,opaque:E.transparent===!1&&E.blending===Gr&&E.alphaToCoverage===!1,alphaMap:ot,alphaTest:It,alphaHash:Pt,combine:E.combine,mapUv:te&&_(E.map.channel),aoMapUv:N&&_(E.aoMap.channel),lightMapUv:Vt&&_(E.lightMap.channel),bumpMapUv:ut&&_(E.bumpMap.channel),normalMapUv:Tt&&_(E.normalMap.channel),displacementMapUv:xt&&_(E.displacementMap.channel),emissiveMapUv:Jt&&_(E.emissiveMap.channel),metalnessMapUv:St&&_(E.metalnessMap.channel),roughnessMapUv:C&&_(E.roughnessMap.channel),anisotropyMapUv:Mt&&_(E.anisotropyMap.channel),clearcoatMapUv:At&&_(E.clearcoatMap.channel),clearcoatNormalMapUv:Kt&&_(E.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:ct&&_(E.clearcoatRoughnessMap.channel),iridescenceMapUv:wt&&_(E.iridescenceMap.channel),iridescenceThicknessMapUv:Xt&&_(E.iridescenceThicknessMap.channel),sheenColorMapUv:$t&&_(E.sheenColorMap.channel),sheenRoughnessMapUv:Rt&&_(E.sheenRoughnessMap.channel),specularMapUv:ae&&_(E.specularMap.channel),specularColorMapUv:ee&&_(E.specularColorMap.channel),specularIntensityMapUv:we&&_(E.specularIntensityMap.channel),transmissionMapUv:z&&_(E.transmissionMap.channel),thicknessMapUv:Et&&_(E.thicknessMap.channel),alphaMapUv:ot&&_(E.alphaMap.channel),vertexTangents:!!Z.attributes.tangent&&(Tt||b),vertexColors:E.vertexColors,vertexAlphas:E.vertexColors===!0&&!!Z.attributes.color&&Z.attributes.color.itemSize===4,pointsUvs:G.isPoints===!0&&!!Z.attributes.uv&&(te||ot),fog:!!X,useFog:E.fog===!0,fogExp2:!!X&&X.isFogExp2,flatShading:E.flatShading===!0,sizeAttenuation:E.sizeAttenuation===!0,logarithmicDepthBuffer:f,reverseDepthBuffer:Ft,skinning:G.isSkinnedMesh===!0,morphTargets:Z.morphAttributes.position!==void 0,morphNormals:Z.morphAttributes.normal!==void 0,morphColors:Z.morphAttributes.color!==void 0,morphTargetsCount:_t,morphTextureStride:pt,numDirLights:M.directional.length,numPointLights:M.point.length,numSpotLights:M.spot.length,numSpotLightMaps:M.spotLightMap.length,numRectAreaLights:M.rectArea.length,numHemiLights:M.hemi.length,numDirLightShadows:M.directionalShadowMap.length,numPointLightShadows:M.pointShadowMap.length,numSpotLightShadows:M.spotShadowMap.length,numSpotLightShadowsWithMaps:M.numSpotLightShadowsWithMaps,numLightProbes:M.numLightProbes,numClippingPlanes:o.numPlanes,numClipIntersection:o.numIntersection,dithering:E.dithering,shadowMapEnabled:i.shadowMap.enabled&&A.length>0,shadowMapType:i.shadowMap.type,toneMapping:We,decodeVideoTexture:te&&E.map.isVideoTexture===!0&&be.getTransfer(E.map.colorSpace)===Le,decodeVideoTextureEmissive:Jt&&E.emissiveMap.isVideoTexture===!0&&be.getTransfer(E.emissiveMap.colorSpace)===Le,premultipliedAlpha:E.premultipliedAlpha,doubleSided:E.side===yi,flipSided:E.side===zn,useDepthPacking:E.depthPacking>=0,depthPacking:E.depthPacking||0,index0AttributeName:E.index0AttributeName,extensionClipCullDistance:se&&E.extensions.clipCullDistance===!0&&n.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(se&&E.extensions.multiDraw===!0||Ut)&&n.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:n.has("KHR_parallel_shader_compile"),customProgramCacheKey:E.customProgramCacheKey()};return Bt.vertexUv1s=c.has(1),Bt.vertexUv2s=c.has(2),Bt.vertexUv3s=c.has(3),c.clear(),Bt}function p(E){let M=[];if(E.shaderID?M.push(E.shaderID):(M.push(E.customVertexShaderID),M.push(E.customFragmentShaderID)),E.defines!==void 0)for(let A in E.defines)M.push(A),M.push(E.defines[A]);return E.isRawShaderMaterial===!1&&(S(M,E),v(M,E),M.push(i.outputColorSpace)),M.push(E.customProgramCacheKey),M.join()}function S(E,M){E.push(M.precision),E.push(M.outputColorSpace),E.push(M.envMapMode),E.push(M.envMapCubeUVHeight),E.push(M.mapUv),E.push(M.alphaMapUv),E.push(M.lightMapUv),E.push(M.aoMapUv),E.push(M.bumpMapUv),E.push(M.normalMapUv),E.push(M.displacementMapUv),E.push(M.emissiveMapUv),E.push(M.metalnessMapUv),E.push(M.roughnessMapUv),E.push(M.anisotropyMapUv),E.push(M.clearcoatMapUv),E.push(M.clearcoatNormalMapUv),E.push(M.clearcoatRoughnessMapUv),E.push(M.iridescenceMapUv),E.push(M.iridescenceThicknessMapUv),E.push(M.sheenColorMapUv),E.push(M.sheenRoughnessMapUv),E.push(M.specularMapUv),E.push(M.specularColorMapUv),E.push(M.specularIntensityMapUv),E.push(M.transmissionMapUv),E.push(M.thicknessMapUv),E.push(M.combine),E.push(M.fogExp2),E.push(M.sizeAttenuation),E.push(M.morphTargetsCount),E.push(M.morphAttributeCount),E.push(M.numDirLights),E.push(M.numPointLights),E.push(M.numSpotLights),E.push(M.numSpotLightMaps),E.push(M.numHemiLights),E.push(M.numRectAreaLights),E.push(M.numDirLightShadows),E.push(M.numPointLightShadows),E.push(M.numSpotLightShadows),E.push(M.numSpotLightShadowsWithMaps),E.push(M.numLightProbes),E.push(M.shadowMapType),E.push(M.toneMapping),E.push(M.numClippingPlanes),E.push(M.numClipIntersection),E.push(M.depthPacking)}function v(E,M){a.disableAll(),M.supportsVertexTextures&&a.enable(0),M.instancing&&a.enable(1),M.instancingColor&&a.enable(2),M.instancingMorph&&a.enable(3),M.matcap&&a.enable(4),M.envMap&&a.enable(5),M.normalMapObjectSpace&&a.enable(6),M.normalMapTangentSpace&&a.enable(7),M.clearcoat&&a.enable(8),M.iridescence&&a.enable(9),M.alphaTest&&a.enable(10),M.vertexColors&&a.enable(11),M.vertexAlphas&&a.enable(12),M.vertexUv1s&&a.enable(13),M.vertexUv2s&&a.enable(14),M.vertexUv3s&&a.enable(15),M.vertexTangents&&a.enable(16),M.anisotropy&&a.enable(17),M.alphaHash&&a.enable(18),M.batching&&a.enable(19),M.dispersion&&a.enable(20),M.batchingColor&&a.enable(21),E.push(a.mask),a.disableAll(),M.fog&&a.enable(0),M.useFog&&a.enable(1),M.flatShading&&a.enable(2),M.logarithmicDepthBuffer&&a.enable(3),M.reverseDepthBuffer&&a.enable(4),M.skinning&&a.enable(5),M.morphTargets&&a.enable(6),M.morphNormals&&a.enable(7),M.morphColors&&a.enable(8),M.premultipliedAlpha&&a.enable(9),M.shadowMapEnabled&&a.enable(10),M.doubleSided&&a.enable(11),M.flipSided&&a.enable(12),M.useDepthPacking&&a.enable(13),M.dithering&&a.enable(14),M.transmission&&a.enable(15),M.sheen&&a.enable(16),M.opaque&&a.enable(17),M.pointsUvs&&a.enable(18),M.decodeVideoTexture&&a.enable(19),M.decodeVideoTextureEmissive&&a.enable(20),M.alphaToCoverage&&a.enable(21),E.push(a.mask)}function y(E){let M=m[E.type],A;if(M){let W=Nn[M];A=Hl.clone(W.uniforms)}else A=E.uniforms;return A}function U(E,M){let A;for(let W=0,G=h.length;W<G;W++){let X=h[W];if(X.cacheKey===M){A=X,++A.usedTimes;break}}return A===void 0&&(A=new nS(i,M,E,r),h.push(A)),A}function R(E){if(--E.usedTimes===0){let M=h.indexOf(E);h[M]=h[h.length-1],h.pop(),E.destroy()}}function P(E){l.remove(E)}function F(){l.dispose()}return{getParameters:g,getProgramCacheKey:p,getUniforms:y,acquireProgram:U,releaseProgram:R,releaseShaderCache:P,programs:h,dispose:F}}function rS(){let i=new WeakMap;function t(o){return i.has(o)}function e(o){let a=i.get(o);return a===void 0&&(a={},i.set(o,a)),a}function n(o){i.delete(o)}function s(o,a,l){i.get(o)[a]=l}function r(){i=new WeakMap}return{has:t,get:e,remove:n,update:s,dispose:r}}function oS(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.material.id!==t.material.id?i.material.id-t.material.id:i.z!==t.z?i.z-t.z:i.id-t.id}function Op(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.z!==t.z?t.z-i.z:i.id-t.id}function Bp(){let i=[],t=0,e=[],n=[],s=[];function r(){t=0,e.length=0,n.length=0,s.length=0}function o(f,u,d,m,_,g){let p=i[t];return p===void 0?(p={id:f.id,object:f,geometry:u,material:d,groupOrder:m,renderOrder:f.renderOrder,z:_,group:g},i[t]=p):(p.id=f.id,p.object=f,p.geometry=u,p.material=d,p.groupOrder=m,p.renderOrder=f.renderOrder,p.z=_,p.group=g),t++,p}function a(f,u,d,m,_,g){let p=o(f,u,d,m,_,g);d.transmission>0?n.push(p):d.transparent===!0?s.push(p):e.push(p)}function l(f,u,d,m,_,g){let p=o(f,u,d,m,_,g);d.transmission>0?n.unshift(p):d.transparent===!0?s.unshift(p):e.unshift(p)}function c(f,u){e.length>1&&e.sort(f||oS),n.length>1&&n.sort(u||Op),s.length>1&&s.sort(u||Op)}function h(){for(let f=t,u=i.length;f<u;f++){let d=i[f];if(d.id===null)break;d.id=null,d.object=null,d.geometry=null,d.material=null,d.group=null}}return{opaque:e,transmissive:n,transparent:s,init:r,push:a,unshift:l,finish:h,sort:c}}function aS(){let i=new WeakMap;function t(n,s){let r=i.get(n),o;return r===void 0?(o=new Bp,i.set(n,[o])):s>=r.length?(o=new Bp,r.push(o)):o=r[s],o}function e(){i=new WeakMap}return{get:t,dispose:e}}function lS(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"DirectionalLight":e={direction:new D,color:new oe};break;case"SpotLight":e={position:new D,direction:new D,color:new oe,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":e={position:new D,color:new oe,distance:0,decay:0};break;case"HemisphereLight":e={direction:new D,skyColor:new oe,groundColor:new oe};break;case"RectAreaLight":e={color:new oe,position:new D,halfWidth:new D,halfHeight:new D};break}return i[t.id]=e,e}}}function cS(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"DirectionalLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new gt};break;case"SpotLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new gt};break;case"PointLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new gt,shadowCameraNear:1,shadowCameraFar:1e3};break}return i[t.id]=e,e}}}var hS=0;function uS(i,t){return(t.castShadow?2:0)-(i.castShadow?2:0)+(t.map?1:0)-(i.map?1:0)}function fS(i){let t=new lS,e=cS(),n={version:0,hash:{directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new D);let s=new D,r=new ze,o=new ze;function a(c){let h=0,f=0,u=0;for(let E=0;E<9;E++)n.probe[E].set(0,0,0);let d=0,m=0,_=0,g=0,p=0,S=0,v=0,y=0,U=0,R=0,P=0;c.sort(uS);for(let E=0,M=c.length;E<M;E++){let A=c[E],W=A.color,G=A.intensity,X=A.distance,Z=A.shadow&&A.shadow.map?A.shadow.map.texture:null;if(A.isAmbientLight)h+=W.r*G,f+=W.g*G,u+=W.b*G;else if(A.isLightProbe){for(let Y=0;Y<9;Y++)n.probe[Y].addScaledVector(A.sh.coefficients[Y],G);P++}else if(A.isDirectionalLight){let Y=t.get(A);if(Y.color.copy(A.color).multiplyScalar(A.intensity),A.castShadow){let nt=A.shadow,Q=e.get(A);Q.shadowIntensity=nt.intensity,Q.shadowBias=nt.bias,Q.shadowNormalBias=nt.normalBias,Q.shadowRadius=nt.radius,Q.shadowMapSize=nt.mapSize,n.directionalShadow[d]=Q,n.directionalShadowMap[d]=Z,n.directionalShadowMatrix[d]=A.shadow.matrix,S++}n.directional[d]=Y,d++}else if(A.isSpotLight){let Y=t.get(A);Y.position.setFromMatrixPosition(A.matrixWorld),Y.color.copy(W).multiplyScalar(G),Y.distance=X,Y.coneCos=Math.cos(A.angle),Y.penumbraCos=Math.cos(A.angle*(1-A.penumbra)),Y.decay=A.decay,n.spot[_]=Y;let nt=A.shadow;if(A.map&&(n.spotLightMap[U]=A.map,U++,nt.updateMatrices(A),A.castShadow&&R++),n.spotLightMatrix[_]=nt.matrix,A.castShadow){let Q=e.get(A);Q.shadowIntensity=nt.intensity,Q.shadowBias=nt.bias,Q.shadowNormalBias=nt.normalBias,Q.shadowRadius=nt.radius,Q.shadowMapSize=nt.mapSize,n.spotShadow[_]=Q,n.spotShadowMap[_]=Z,y++}_++}else if(A.isRectAreaLight){let Y=t.get(A);Y.color.copy(W).multiplyScalar(G),Y.halfWidth.set(A.width*.5,0,0),Y.halfHeight.set(0,A.height*.5,0),n.rectArea[g]=Y,g++}else if(A.isPointLight){let Y=t.get(A);if(Y.color.copy(A.color).multiplyScalar(A.intensity),Y.distance=A.distance,Y.decay=A.decay,A.castShadow){let nt=A.shadow,Q=e.get(A);Q.shadowIntensity=nt.intensity,Q.shadowBias=nt.bias,Q.shadowNormalBias=nt.normalBias,Q.shadowRadius=nt.radius,Q.shadowMapSize=nt.mapSize,Q.shadowCameraNear=nt.camera.near,Q.shadowCameraFar=nt.camera.far,n.pointShadow[m]=Q,n.pointShadowMap[m]=Z,n.pointShadowMatrix[m]=A.shadow.matrix,v++}n.point[m]=Y,m++}else if(A.isHemisphereLight){let Y=t.get(A);Y.skyColor.copy(A.color).multiplyScalar(G),Y.groundColor.copy(A.groundColor).multiplyScalar(G),n.hemi[p]=Y,p++}}g>0&&(i.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=bt.LTC_FLOAT_1,n.rectAreaLTC2=bt.LTC_FLOAT_2):(n.rectAreaLTC1=bt.LTC_HALF_1,n.rectAreaLTC2=bt.LTC_HALF_2)),n.ambient[0]=h,n.ambient[1]=f,n.ambient[2]=u;let F=n.hash;(F.directionalLength!==d||F.pointLength!==m||F.spotLength!==_||F.rectAreaLength!==g||F.hemiLength!==p||F.numDirectionalShadows!==S||F.numPointShadows!==v||F.numSpotShadows!==y||F.numSpotMaps!==U||F.numLightProbes!==P)&&(n.directional.length=d,n.spot.length=_,n.rectArea.length=g,n.point.length=m,n.hemi.length=p,n.directionalShadow.length=S,n.directionalShadowMap.length=S,n.pointShadow.length=v,n.pointShadowMap.length=v,n.spotShadow.length=y,n.spotShadowMap.length=y,n.directionalShadowMatrix.length=S,n.pointShadowMatrix.length=v,n.spotLightMatrix.length=y+U-R,n.spotLightMap.length=U,n.numSpotLightShadowsWithMaps=R,n.numLightProbes=P,F.directionalLength=d,F.pointLength=m,F.spotLength=_,F.rectAreaLength=g,F.hemiLength=p,F.numDirectionalShadows=S,F.numPointShadows=v,F.numSpotShadows=y,F.numSpotMaps=U,F.numLightProbes=P,n.version=hS++)}function l(c,h){let f=0,u=0,d=0,m=0,_=0,g=h.matrixWorldInverse;for(let p=0,S=c.length;p<S;p++){let v=c[p];if(v.isDirectionalLight){let y=n.directional[f];y.direction.setFromMatrixPosition(v.matrixWorld),s.setFromMatrixPosition(v.target.matrixWorld),y.direction.sub(s),y.direction.transformDirection(g),f++}else if(v.isSpotLight){let y=n.spot[d];y.position.setFromMatrixPosition(v.matrixWorld),y.position.applyMatrix4(g),y.direction.setFromMatrixPosition(v.matrixWorld),s.setFromMatrixPosition(v.target.matrixWorld),y.direction.sub(s),y.direction.transformDirection(g),d++}else if(v.isRectAreaLight){let y=n.rectArea[m];y.position.setFromMatrixPosition(v.matrixWorld),y.position.applyMatrix4(g),o.identity(),r.copy(v.matrixWorld),r.premultiply(g),o.extractRotation(r),y.halfWidth.set(v.width*.5,0,0),y.halfHeight.set(0,v.height*.5,0),y.halfWidth.applyMatrix4(o),y.halfHeight.applyMatrix4(o),m++}else if(v.isPointLight){let y=n.point[u];y.position.setFromMatrixPosition(v.matrixWorld),y.position.applyMatrix4(g),u++}else if(v.isHemisphereLight){let y=n.hemi[_];y.direction.setFromMatrixPosition(v.matrixWorld),y.direction.transformDirection(g),_++}}}return{setup:a,setupView:l,state:n}}function zp(i){let t=new fS(i),e=[],n=[];function s(h){c.camera=h,e.length=0,n.length=0}function r(h){e.push(h)}function o(h){n.push(h)}function a(){t.setup(e)}function l(h){t.setupView(e,h)}let c={lightsArray:e,shadowsArray:n,camera:null,lights:t,transmissionRenderTarget:{}};return{init:s,state:c,setupLights:a,setupLightsView:l,pushLight:r,pushShadow:o}}function dS(i){let t=new WeakMap;function e(s,r=0){let o=t.get(s),a;return o===void 0?(a=new zp(i),t.set(s,[a])):r>=o.length?(a=new zp(i),o.push(a)):a=o[r],a}function n(){t=new WeakMap}return{get:e,dispose:n}}var Au=class extends Ds{static get type(){return"MeshDepthMaterial"}constructor(t){super(),this.isMeshDepthMaterial=!0,this.depthPacking=ox,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(t)}copy(t){return super.copy(t),this.depthPacking=t.depthPacking,this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this}},Cu=class extends Ds{static get type(){return"MeshDistanceMaterial"}constructor(t){super(),this.isMeshDistanceMaterial=!0,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(t)}copy(t){return super.copy(t),this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this}},pS=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,mS=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
#include <packing>
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = unpackRGBATo2Half( texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ) );
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = unpackRGBAToDepth( texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ) );
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( squared_mean - mean * mean );
	gl_FragColor = pack2HalfToRGBA( vec2( mean, std_dev ) );
}`;function gS(i,t,e){let n=new Vo,s=new gt,r=new gt,o=new De,a=new Au({depthPacking:ax}),l=new Cu,c={},h=e.maxTextureSize,f={[Ls]:zn,[zn]:Ls,[yi]:yi},u=new ai({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new gt},radius:{value:4}},vertexShader:pS,fragmentShader:mS}),d=u.clone();d.defines.HORIZONTAL_PASS=1;let m=new ve;m.setAttribute("position",new $n(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let _=new xe(m,u),g=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=em;let p=this.type;this.render=function(R,P,F){if(g.enabled===!1||g.autoUpdate===!1&&g.needsUpdate===!1||R.length===0)return;let E=i.getRenderTarget(),M=i.getActiveCubeFace(),A=i.getActiveMipmapLevel(),W=i.state;W.setBlending(Rs),W.buffers.color.setClear(1,1,1,1),W.buffers.depth.setTest(!0),W.setScissorTest(!1);let G=p!==ss&&this.type===ss,X=p===ss&&this.type!==ss;for(let Z=0,Y=R.length;Z<Y;Z++){let nt=R[Z],Q=nt.shadow;if(Q===void 0){console.warn("THREE.WebGLShadowMap:",nt,"has no shadow.");continue}if(Q.autoUpdate===!1&&Q.needsUpdate===!1)continue;s.copy(Q.mapSize);let dt=Q.getFrameExtents();if(s.multiply(dt),r.copy(Q.mapSize),(s.x>h||s.y>h)&&(s.x>h&&(r.x=Math.floor(h/dt.x),s.x=r.x*dt.x,Q.mapSize.x=r.x),s.y>h&&(r.y=Math.floor(h/dt.y),s.y=r.y*dt.y,Q.mapSize.y=r.y)),Q.map===null||G===!0||X===!0){let _t=this.type!==ss?{minFilter:bi,magFilter:bi}:{};Q.map!==null&&Q.map.dispose(),Q.map=new hs(s.x,s.y,_t),Q.map.texture.name=nt.name+".shadowMap",Q.camera.updateProjectionMatrix()}i.setRenderTarget(Q.map),i.clear();let at=Q.getViewportCount();for(let _t=0;_t<at;_t++){let pt=Q.getViewport(_t);o.set(r.x*pt.x,r.y*pt.y,r.x*pt.z,r.y*pt.w),W.viewport(o),Q.updateMatrices(nt,_t),n=Q.getFrustum(),y(P,F,Q.camera,nt,this.type)}Q.isPointLightShadow!==!0&&this.type===ss&&S(Q,F),Q.needsUpdate=!1}p=this.type,g.needsUpdate=!1,i.setRenderTarget(E,M,A)};function S(R,P){let F=t.update(_);u.defines.VSM_SAMPLES!==R.blurSamples&&(u.defines.VSM_SAMPLES=R.blurSamples,d.defines.VSM_SAMPLES=R.blurSamples,u.needsUpdate=!0,d.needsUpdate=!0),R.mapPass===null&&(R.mapPass=new hs(s.x,s.y)),u.uniforms.shadow_pass.value=R.map.texture,u.uniforms.resolution.value=R.mapSize,u.uniforms.radius.value=R.radius,i.setRenderTarget(R.mapPass),i.clear(),i.renderBufferDirect(P,null,F,u,_,null),d.uniforms.shadow_pass.value=R.mapPass.texture,d.uniforms.resolution.value=R.mapSize,d.uniforms.radius.value=R.radius,i.setRenderTarget(R.map),i.clear(),i.renderBufferDirect(P,null,F,d,_,null)}function v(R,P,F,E){let M=null,A=F.isPointLight===!0?R.customDistanceMaterial:R.customDepthMaterial;if(A!==void 0)M=A;else if(M=F.isPointLight===!0?l:a,i.localClippingEnabled&&P.clipShadows===!0&&Array.isArray(P.clippingPlanes)&&P.clippingPlanes.length!==0||P.displacementMap&&P.displacementScale!==0||P.alphaMap&&P.alphaTest>0||P.map&&P.alphaTest>0){let W=M.uuid,G=P.uuid,X=c[W];X===void 0&&(X={},c[W]=X);let Z=X[G];Z===void 0&&(Z=M.clone(),X[G]=Z,P.addEventListener("dispose",U)),M=Z}if(M.visible=P.visible,M.wireframe=P.wireframe,E===ss?M.side=P.shadowSide!==null?P.shadowSide:P.side:M.side=P.shadowSide!==null?P.shadowSide:f[P.side],M.alphaMap=P.alphaMap,M.alphaTest=P.alphaTest,M.map=P.map,M.clipShadows=P.clipShadows,M.clippingPlanes=P.clippingPlanes,M.clipIntersection=P.clipIntersection,M.displacementMap=P.displacementMap,M.displacementScale=P.displacementScale,M.displacementBias=P.displacementBias,M.wireframeLinewidth=P.wireframeLinewidth,M.linewidth=P.linewidth,F.isPointLight===!0&&M.isMeshDistanceMaterial===!0){let W=i.properties.get(M);W.light=F}return M}function y(R,P,F,E,M){if(R.visible===!1)return;if(R.layers.test(P.layers)&&(R.isMesh||R.isLine||R.isPoints)&&(R.castShadow||R.receiveShadow&&M===ss)&&(!R.frustumCulled||n.intersectsObject(R))){R.modelViewMatrix.multiplyMatrices(F.matrixWorldInverse,R.matrixWorld);let G=t.update(R),X=R.material;if(Array.isArray(X)){let Z=G.groups;for(let Y=0,nt=Z.length;Y<nt;Y++){let Q=Z[Y],dt=X[Q.materialIndex];if(dt&&dt.visible){let at=v(R,dt,E,M);R.onBeforeShadow(i,R,P,F,G,at,Q),i.renderBufferDirect(F,null,G,at,R,Q),R.onAfterShadow(i,R,P,F,G,at,Q)}}}else if(X.visible){let Z=v(R,X,E,M);R.onBeforeShadow(i,R,P,F,G,Z,null),i.renderBufferDirect(F,null,G,Z,R,null),R.onAfterShadow(i,R,P,F,G,Z,null)}}let W=R.children;for(let G=0,X=W.length;G<X;G++)y(W[G],P,F,E,M)}function U(R){R.target.removeEventListener("dispose",U);for(let F in c){let E=c[F],M=R.target.uuid;M in E&&(E[M].dispose(),delete E[M])}}}var _S={[Ih]:Lh,[Dh]:Fh,[Uh]:Oh,[$r]:Nh,[Lh]:Ih,[Fh]:Dh,[Oh]:Uh,[Nh]:$r};function xS(i,t){function e(){let z=!1,Et=new De,it=null,ot=new De(0,0,0,0);return{setMask:function(It){it!==It&&!z&&(i.colorMask(It,It,It,It),it=It)},setLocked:function(It){z=It},setClear:function(It,Pt,se,We,Bt){Bt===!0&&(It*=We,Pt*=We,se*=We),Et.set(It,Pt,se,We),ot.equals(Et)===!1&&(i.clearColor(It,Pt,se,We),ot.copy(Et))},reset:function(){z=!1,it=null,ot.set(-1,0,0,0)}}}function n(){let z=!1,Et=!1,it=null,ot=null,It=null;return{setReversed:function(Pt){if(Et!==Pt){let se=t.get("EXT_clip_control");Et?se.clipControlEXT(se.LOWER_LEFT_EXT,se.ZERO_TO_ONE_EXT):se.clipControlEXT(se.LOWER_LEFT_EXT,se.NEGATIVE_ONE_TO_ONE_EXT);let We=It;It=null,this.setClear(We)}Et=Pt},getReversed:function(){return Et},setTest:function(Pt){Pt?lt(i.DEPTH_TEST):Ft(i.DEPTH_TEST)},setMask:function(Pt){it!==Pt&&!z&&(i.depthMask(Pt),it=Pt)},setFunc:function(Pt){if(Et&&(Pt=_S[Pt]),ot!==Pt){switch(Pt){case Ih:i.depthFunc(i.NEVER);break;case Lh:i.depthFunc(i.ALWAYS);break;case Dh:i.depthFunc(i.LESS);break;case $r:i.depthFunc(i.LEQUAL);break;case Uh:i.depthFunc(i.EQUAL);break;case Nh:i.depthFunc(i.GEQUAL);break;case Fh:i.depthFunc(i.GREATER);break;case Oh:i.depthFunc(i.NOTEQUAL);break;default:i.depthFunc(i.LEQUAL)}ot=Pt}},setLocked:function(Pt){z=Pt},setClear:function(Pt){It!==Pt&&(Et&&(Pt=1-Pt),i.clearDepth(Pt),It=Pt)},reset:function(){z=!1,it=null,ot=null,It=null,Et=!1}}}function s(){let z=!1,Et=null,it=null,ot=null,It=null,Pt=null,se=null,We=null,Bt=null;return{setTest:function(fe){z||(fe?lt(i.STENCIL_TEST):Ft(i.STENCIL_TEST))},setMask:function(fe){Et!==fe&&!z&&(i.stencilMask(fe),Et=fe)},setFunc:function(fe,Pe,un){(it!==fe||ot!==Pe||It!==un)&&(i.stencilFunc(fe,Pe,un),it=fe,ot=Pe,It=un)},setOp:function(fe,Pe,un){(Pt!==fe||se!==Pe||We!==un)&&(i.stencilOp(fe,Pe,un),Pt=fe,se=Pe,We=un)},setLocked:function(fe){z=fe},setClear:function(fe){Bt!==fe&&(i.clearStencil(fe),Bt=fe)},reset:function(){z=!1,Et=null,it=null,ot=null,It=null,Pt=null,se=null,We=null,Bt=null}}}let r=new e,o=new n,a=new s,l=new WeakMap,c=new WeakMap,h={},f={},u=new WeakMap,d=[],m=null,_=!1,g=null,p=null,S=null,v=null,y=null,U=null,R=null,P=new oe(0,0,0),F=0,E=!1,M=null,A=null,W=null,G=null,X=null,Z=i.getParameter(i.MAX_COMBINED_TEXTURE_IMAGE_UNITS),Y=!1,nt=0,Q=i.getParameter(i.VERSION);Q.indexOf("WebGL")!==-1?(nt=parseFloat(/^WebGL (\d)/.exec(Q)[1]),Y=nt>=1):Q.indexOf("OpenGL ES")!==-1&&(nt=parseFloat(/^OpenGL ES (\d)/.exec(Q)[1]),Y=nt>=2);let dt=null,at={},_t=i.getParameter(i.SCISSOR_BOX),pt=i.getParameter(i.VIEWPORT),Zt=new De().fromArray(_t),J=new De().fromArray(pt);function ht(z,Et,it,ot){let It=new Uint8Array(4),Pt=i.createTexture();i.bindTexture(z,Pt),i.texParameteri(z,i.TEXTURE_MIN_FILTER,i.NEAREST),i.texParameteri(z,i.TEXTURE_MAG_FILTER,i.NEAREST);for(let se=0;se<it;se++)z===i.TEXTURE_3D||z===i.TEXTURE_2D_ARRAY?i.texImage3D(Et,0,i.RGBA,1,1,ot,0,i.RGBA,i.UNSIGNED_BYTE,It):i.texImage2D(Et+se,0,i.RGBA,1,1,0,i.RGBA,i.UNSIGNED_BYTE,It);return Pt}let Ot={};Ot[i.TEXTURE_2D]=ht(i.TEXTURE_2D,i.TEXTURE_2D,1),Ot[i.TEXTURE_CUBE_MAP]=ht(i.TEXTURE_CUBE_MAP,i.TEXTURE_CUBE_MAP_POSITIVE_X,6),Ot[i.TEXTURE_2D_ARRAY]=ht(i.TEXTURE_2D_ARRAY,i.TEXTURE_2D_ARRAY,1,1),Ot[i.TEXTURE_3D]=ht(i.TEXTURE_3D,i.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),lt(i.DEPTH_TEST),o.setFunc($r),ut(!1),Tt(Vd),lt(i.CULL_FACE),N(Rs);function lt(z){h[z]!==!0&&(i.enable(z),h[z]=!0)}function Ft(z){h[z]!==!1&&(i.disable(z),h[z]=!1)}function Yt(z,Et){return f[z]!==Et?(i.bindFramebuffer(z,Et),f[z]=Et,z===i.DRAW_FRAMEBUFFER&&(f[i.FRAMEBUFFER]=Et),z===i.FRAMEBUFFER&&(f[i.DRAW_FRAMEBUFFER]=Et),!0):!1}function Ut(z,Et){let it=d,ot=!1;if(z){it=u.get(Et),it===void 0&&(it=[],u.set(Et,it));let It=z.textures;if(it.length!==It.length||it[0]!==i.COLOR_ATTACHMENT0){for(let Pt=0,se=It.length;Pt<se;Pt++)it[Pt]=i.COLOR_ATTACHMENT0+Pt;it.length=It.length,ot=!0}}else it[0]!==i.BACK&&(it[0]=i.BACK,ot=!0);ot&&i.drawBuffers(it)}function te(z){return m!==z?(i.useProgram(z),m=z,!0):!1}let st={[Ks]:i.FUNC_ADD,[D_]:i.FUNC_SUBTRACT,[U_]:i.FUNC_REVERSE_SUBTRACT};st[N_]=i.MIN,st[F_]=i.MAX;let mt={[O_]:i.ZERO,[B_]:i.ONE,[z_]:i.SRC_COLOR,[Rh]:i.SRC_ALPHA,[X_]:i.SRC_ALPHA_SATURATE,[G_]:i.DST_COLOR,[V_]:i.DST_ALPHA,[k_]:i.ONE_MINUS_SRC_COLOR,[Ph]:i.ONE_MINUS_SRC_ALPHA,[W_]:i.ONE_MINUS_DST_COLOR,[H_]:i.ONE_MINUS_DST_ALPHA,[q_]:i.CONSTANT_COLOR,[Y_]:i.ONE_MINUS_CONSTANT_COLOR,[$_]:i.CONSTANT_ALPHA,[Z_]:i.ONE_MINUS_CONSTANT_ALPHA};function N(z,Et,it,ot,It,Pt,se,We,Bt,fe){if(z===Rs){_===!0&&(Ft(i.BLEND),_=!1);return}if(_===!1&&(lt(i.BLEND),_=!0),z!==L_){if(z!==g||fe!==E){if((p!==Ks||y!==Ks)&&(i.blendEquation(i.FUNC_ADD),p=Ks,y=Ks),fe)switch(z){case Gr:i.blendFuncSeparate(i.ONE,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Hd:i.blendFunc(i.ONE,i.ONE);break;case Gd:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case Wd:i.blendFuncSeparate(i.ZERO,i.SRC_COLOR,i.ZERO,i.SRC_ALPHA);break;default:console.error("THREE.WebGLState: Invalid blending: ",z);break}else switch(z){case Gr:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Hd:i.blendFunc(i.SRC_ALPHA,i.ONE);break;case Gd:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case Wd:i.blendFunc(i.ZERO,i.SRC_COLOR);break;default:console.error("THREE.WebGLState: Invalid blending: ",z);break}S=null,v=null,U=null,R=null,P.set(0,0,0),F=0,g=z,E=fe}return}It=It||Et,Pt=Pt||it,se=se||ot,(Et!==p||It!==y)&&(i.blendEquationSeparate(st[Et],st[It]),p=Et,y=It),(it!==S||ot!==v||Pt!==U||se!==R)&&(i.blendFuncSeparate(mt[it],mt[ot],mt[Pt],mt[se]),S=it,v=ot,U=Pt,R=se),(We.equals(P)===!1||Bt!==F)&&(i.blendColor(We.r,We.g,We.b,Bt),P.copy(We),F=Bt),g=z,E=!1}function Vt(z,Et){z.side===yi?Ft(i.CULL_FACE):lt(i.CULL_FACE);let it=z.side===zn;Et&&(it=!it),ut(it),z.blending===Gr&&z.transparent===!1?N(Rs):N(z.blending,z.blendEquation,z.blendSrc,z.blendDst,z.blendEquationAlpha,z.blendSrcAlpha,z.blendDstAlpha,z.blendColor,z.blendAlpha,z.premultipliedAlpha),o.setFunc(z.depthFunc),o.setTest(z.depthTest),o.setMask(z.depthWrite),r.setMask(z.colorWrite);let ot=z.stencilWrite;a.setTest(ot),ot&&(a.setMask(z.stencilWriteMask),a.setFunc(z.stencilFunc,z.stencilRef,z.stencilFuncMask),a.setOp(z.stencilFail,z.stencilZFail,z.stencilZPass)),Jt(z.polygonOffset,z.polygonOffsetFactor,z.polygonOffsetUnits),z.alphaToCoverage===!0?lt(i.SAMPLE_ALPHA_TO_COVERAGE):Ft(i.SAMPLE_ALPHA_TO_COVERAGE)}function ut(z){M!==z&&(z?i.frontFace(i.CW):i.frontFace(i.CCW),M=z)}function Tt(z){z!==R_?(lt(i.CULL_FACE),z!==A&&(z===Vd?i.cullFace(i.BACK):z===P_?i.cullFace(i.FRONT):i.cullFace(i.FRONT_AND_BACK))):Ft(i.CULL_FACE),A=z}function xt(z){z!==W&&(Y&&i.lineWidth(z),W=z)}function Jt(z,Et,it){z?(lt(i.POLYGON_OFFSET_FILL),(G!==Et||X!==it)&&(i.polygonOffset(Et,it),G=Et,X=it)):Ft(i.POLYGON_OFFSET_FILL)}function St(z){z?lt(i.SCISSOR_TEST):Ft(i.SCISSOR_TEST)}function C(z){z===void 0&&(z=i.TEXTURE0+Z-1),dt!==z&&(i.activeTexture(z),dt=z)}function b(z,Et,it){it===void 0&&(dt===null?it=i.TEXTURE0+Z-1:it=dt);let ot=at[it];ot===void 0&&(ot={type:void 0,texture:void 0},at[it]=ot),(ot.type!==z||ot.texture!==Et)&&(dt!==it&&(i.activeTexture(it),dt=it),i.bindTexture(z,Et||Ot[z]),ot.type=z,ot.texture=Et)}function B(){let z=at[dt];z!==void 0&&z.type!==void 0&&(i.bindTexture(z.type,null),z.type=void 0,z.texture=void 0)}function tt(){try{i.compressedTexImage2D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function j(){try{i.compressedTexImage3D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function et(){try{i.texSubImage2D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function Nt(){try{i.texSubImage3D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function Mt(){try{i.compressedTexSubImage2D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function At(){try{i.compressedTexSubImage3D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function Kt(){try{i.texStorage2D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function ct(){try{i.texStorage3D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function wt(){try{i.texImage2D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function Xt(){try{i.texImage3D.apply(i,arguments)}catch(z){console.error("THREE.WebGLState:",z)}}function $t(z){Zt.equals(z)===!1&&(i.scissor(z.x,z.y,z.z,z.w),Zt.copy(z))}function Rt(z){J.equals(z)===!1&&(i.viewport(z.x,z.y,z.z,z.w),J.copy(z))}function ae(z,Et){let it=c.get(Et);it===void 0&&(it=new WeakMap,c.set(Et,it));let ot=it.get(z);ot===void 0&&(ot=i.getUniformBlockIndex(Et,z.name),it.set(z,ot))}function ee(z,Et){let ot=c.get(Et).get(z);l.get(Et)!==ot&&(i.uniformBlockBinding(Et,ot,z.__bindingPointIndex),l.set(Et,ot))}function we(){i.disable(i.BLEND),i.disable(i.CULL_FACE),i.disable(i.DEPTH_TEST),i.disable(i.POLYGON_OFFSET_FILL),i.disable(i.SCISSOR_TEST),i.disable(i.STENCIL_TEST),i.disable(i.SAMPLE_ALPHA_TO_COVERAGE),i.blendEquation(i.FUNC_ADD),i.blendFunc(i.ONE,i.ZERO),i.blendFuncSeparate(i.ONE,i.ZERO,i.ONE,i.ZERO),i.blendColor(0,0,0,0),i.colorMask(!0,!0,!0,!0),i.clearColor(0,0,0,0),i.depthMask(!0),i.depthFunc(i.LESS),o.setReversed(!1),i.clearDepth(1),i.stencilMask(4294967295),i.stencilFunc(i.ALWAYS,0,4294967295),i.stencilOp(i.KEEP,i.KEEP,i.KEEP),i.clearStencil(0),i.cullFace(i.BACK),i.frontFace(i.CCW),i.polygonOffset(0,0),i.activeTexture(i.TEXTURE0),i.bindFramebuffer(i.FRAMEBUFFER,null),i.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),i.bindFramebuffer(i.READ_FRAMEBUFFER,null),i.useProgram(null),i.lineWidth(1),i.scissor(0,0,i.canvas.width,i.canvas.height),i.viewport(0,0,i.canvas.width,i.canvas.height),h={},dt=null,at={},f={},u=new WeakMap,d=[],m=null,_=!1,g=null,p=null,S=null,v=null,y=null,U=null,R=null,P=new oe(0,0,0),F=0,E=!1,M=null,A=null,W=null,G=null,X=null,Zt.set(0,0,i.canvas.width,i.canvas.height),J.set(0,0,i.canvas.width,i.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:lt,disable:Ft,bindFramebuffer:Yt,drawBuffers:Ut,useProgram:te,setBlending:N,setMaterial:Vt,setFlipSided:ut,setCullFace:Tt,setLineWidth:xt,setPolygonOffset:Jt,setScissorTest:St,activeTexture:C,bindTexture:b,unbindTexture:B,compressedTexImage2D:tt,compressedTexImage3D:j,texImage2D:wt,texImage3D:Xt,updateUBOMapping:ae,uniformBlockBinding:ee,texStorage2D:Kt,texStorage3D:ct,texSubImage2D:et,texSubImage3D:Nt,compressedTexSubImage2D:Mt,compressedTexSubImage3D:At,scissor:$t,viewport:Rt,reset:we}}function kp(i,t,e,n){let s=yS(n);switch(e){case om:return i*t;case lm:return i*t;case cm:return i*t*2;case hm:return i*t/s.components*s.byteLength;case lf:return i*t/s.components*s.byteLength;case um:return i*t*2/s.components*s.byteLength;case cf:return i*t*2/s.components*s.byteLength;case am:return i*t*3/s.components*s.byteLength;case Mi:return i*t*4/s.components*s.byteLength;case hf:return i*t*4/s.components*s.byteLength;case ja:case Qa:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case tl:case el:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Gh:case Xh:return Math.max(i,16)*Math.max(t,8)/4;case Hh:case Wh:return Math.max(i,8)*Math.max(t,8)/2;case qh:case Yh:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case $h:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Zh:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Jh:return Math.floor((i+4)/5)*Math.floor((t+3)/4)*16;case Kh:return Math.floor((i+4)/5)*Math.floor((t+4)/5)*16;case jh:return Math.floor((i+5)/6)*Math.floor((t+4)/5)*16;case Qh:return Math.floor((i+5)/6)*Math.floor((t+5)/6)*16;case tu:return Math.floor((i+7)/8)*Math.floor((t+4)/5)*16;case eu:return Math.floor((i+7)/8)*Math.floor((t+5)/6)*16;case nu:return Math.floor((i+7)/8)*Math.floor((t+7)/8)*16;case iu:return Math.floor((i+9)/10)*Math.floor((t+4)/5)*16;case su:return Math.floor((i+9)/10)*Math.floor((t+5)/6)*16;case ru:return Math.floor((i+9)/10)*Math.floor((t+7)/8)*16;case ou:return Math.floor((i+9)/10)*Math.floor((t+9)/10)*16;case au:return Math.floor((i+11)/12)*Math.floor((t+9)/10)*16;case lu:return Math.floor((i+11)/12)*Math.floor((t+11)/12)*16;case nl:case cu:case hu:return Math.ceil(i/4)*Math.ceil(t/4)*16;case fm:case uu:return Math.ceil(i/4)*Math.ceil(t/4)*8;case fu:case du:return Math.ceil(i/4)*Math.ceil(t/4)*16}throw new Error(`Unable to determine texture byte length for ${e} format.`)}function yS(i){switch(i){case ls:case im:return{byteLength:1,components:1};case Bo:case sm:case Yo:return{byteLength:2,components:1};case of:case af:return{byteLength:2,components:4};case er:case rf:case rs:return{byteLength:4,components:1};case rm:return{byteLength:4,components:3}}throw new Error(`Unknown texture type ${i}.`)}function vS(i,t,e,n,s,r,o){let a=t.has("WEBGL_multisampled_render_to_texture")?t.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new gt,h=new WeakMap,f,u=new WeakMap,d=!1;try{d=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function m(C,b){return d?new OffscreenCanvas(C,b):rl("canvas")}function _(C,b,B){let tt=1,j=St(C);if((j.width>B||j.height>B)&&(tt=B/Math.max(j.width,j.height)),tt<1)if(typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&C instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&C instanceof ImageBitmap||typeof VideoFrame<"u"&&C instanceof VideoFrame){let et=Math.floor(tt*j.width),Nt=Math.floor(tt*j.height);f===void 0&&(f=m(et,Nt));let Mt=b?m(et,Nt):f;return Mt.width=et,Mt.height=Nt,Mt.getContext("2d").drawImage(C,0,0,et,Nt),console.warn("THREE.WebGLRenderer: Texture has been resized from ("+j.width+"x"+j.height+") to ("+et+"x"+Nt+")."),Mt}else return"data"in C&&console.warn("THREE.WebGLRenderer: Image in DataTexture is too big ("+j.width+"x"+j.height+")."),C;return C}function g(C){return C.generateMipmaps}function p(C){i.generateMipmap(C)}function S(C){return C.isWebGLCubeRenderTarget?i.TEXTURE_CUBE_MAP:C.isWebGL3DRenderTarget?i.TEXTURE_3D:C.isWebGLArrayRenderTarget||C.isCompressedArrayTexture?i.TEXTURE_2D_ARRAY:i.TEXTURE_2D}function v(C,b,B,tt,j=!1){if(C!==null){if(i[C]!==void 0)return i[C];console.warn("THREE.WebGLRenderer: Attempt to use non-existing WebGL internal format '"+C+"'")}let et=b;if(b===i.RED&&(B===i.FLOAT&&(et=i.R32F),B===i.HALF_FLOAT&&(et=i.R16F),B===i.UNSIGNED_BYTE&&(et=i.R8)),b===i.RED_INTEGER&&(B===i.UNSIGNED_BYTE&&(et=i.R8UI),B===i.UNSIGNED_SHORT&&(et=i.R16UI),B===i.UNSIGNED_INT&&(et=i.R32UI),B===i.BYTE&&(et=i.R8I),B===i.SHORT&&(et=i.R16I),B===i.INT&&(et=i.R32I)),b===i.RG&&(B===i.FLOAT&&(et=i.RG32F),B===i.HALF_FLOAT&&(et=i.RG16F),B===i.UNSIGNED_BYTE&&(et=i.RG8)),b===i.RG_INTEGER&&(B===i.UNSIGNED_BYTE&&(et=i.RG8UI),B===i.UNSIGNED_SHORT&&(et=i.RG16UI),B===i.UNSIGNED_INT&&(et=i.RG32UI),B===i.BYTE&&(et=i.RG8I),B===i.SHORT&&(et=i.RG16I),B===i.INT&&(et=i.RG32I)),b===i.RGB_INTEGER&&(B===i.UNSIGNED_BYTE&&(et=i.RGB8UI),B===i.UNSIGNED_SHORT&&(et=i.RGB16UI),B===i.UNSIGNED_INT&&(et=i.RGB32UI),B===i.BYTE&&(et=i.RGB8I),B===i.SHORT&&(et=i.RGB16I),B===i.INT&&(et=i.RGB32I)),b===i.RGBA_INTEGER&&(B===i.UNSIGNED_BYTE&&(et=i.RGBA8UI),B===i.UNSIGNED_SHORT&&(et=i.RGBA16UI),B===i.UNSIGNED_INT&&(et=i.RGBA32UI),B===i.BYTE&&(et=i.RGBA8I),B===i.SHORT&&(et=i.RGBA16I),B===i.INT&&(et=i.RGBA32I)),b===i.RGB&&B===i.UNSIGNED_INT_5_9_9_9_REV&&(et=i.RGB9_E5),b===i.RGBA){let Nt=j?kl:be.getTransfer(tt);B===i.FLOAT&&(et=i.RGBA32F),B===i.HALF_FLOAT&&(et=i.RGBA16F),B===i.UNSIGNED_BYTE&&(et=Nt===Le?i.SRGB8_ALPHA8:i.RGBA8),B===i.UNSIGNED_SHORT_4_4_4_4&&(et=i.RGBA4),B===i.UNSIGNED_SHORT_5_5_5_1&&(et=i.RGB5_A1)}return(et===i.R16F||et===i.R32F||et===i.RG16F||et===i.RG32F||et===i.RGBA16F||et===i.RGBA32F)&&t.get("EXT_color_buffer_float"),et}function y(C,b){let B;return C?b===null||b===er||b===Kr?B=i.DEPTH24_STENCIL8:b===rs?B=i.DEPTH32F_STENCIL8:b===Bo&&(B=i.DEPTH24_STENCIL8,console.warn("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):b===null||b===er||b===Kr?B=i.DEPTH_COMPONENT24:b===rs?B=i.DEPTH_COMPONENT32F:b===Bo&&(B=i.DEPTH_COMPONENT16),B}function U(C,b){return g(C)===!0||C.isFramebufferTexture&&C.minFilter!==bi&&C.minFilter!==Oi?Math.log2(Math.max(b.width,b.height))+1:C.mipmaps!==void 0&&C.mipmaps.length>0?C.mipmaps.length:C.isCompressedTexture&&Array.isArray(C.image)?b.mipmaps.length:1}function R(C){let b=C.target;b.removeEventListener("dispose",R),F(b),b.isVideoTexture&&h.delete(b)}function P(C){let b=C.target;b.removeEventListener("dispose",P),M(b)}function F(C){let b=n.get(C);if(b.__webglInit===void 0)return;let B=C.source,tt=u.get(B);if(tt){let j=tt[b.__cacheKey];j.usedTimes--,j.usedTimes===0&&E(C),Object.keys(tt).length===0&&u.delete(B)}n.remove(C)}function E(C){let b=n.get(C);i.deleteTexture(b.__webglTexture);let B=C.source,tt=u.get(B);delete tt[b.__cacheKey],o.memory.textures--}function M(C){let b=n.get(C);if(C.depthTexture&&(C.depthTexture.dispose(),n.remove(C.depthTexture)),C.isWebGLCubeRenderTarget)for(let tt=0;tt<6;tt++){if(Array.isArray(b.__webglFramebuffer[tt]))for(let j=0;j<b.__webglFramebuffer[tt].length;j++)i.deleteFramebuffer(b.__webglFramebuffer[tt][j]);else i.deleteFramebuffer(b.__webglFramebuffer[tt]);b.__webglDepthbuffer&&i.deleteRenderbuffer(b.__webglDepthbuffer[tt])}else{if(Array.isArray(b.__webglFramebuffer))for(let tt=0;tt<b.__webglFramebuffer.length;tt++)i.deleteFramebuffer(b.__webglFramebuffer[tt]);else i.deleteFramebuffer(b.__webglFramebuffer);if(b.__webglDepthbuffer&&i.deleteRenderbuffer(b.__webglDepthbuffer),b.__webglMultisampledFramebuffer&&i.deleteFramebuffer(b.__webglMultisampledFramebuffer),b.__webglColorRenderbuffer)for(let tt=0;tt<b.__webglColorRenderbuffer.length;tt++)b.__webglColorRenderbuffer[tt]&&i.deleteRenderbuffer(b.__webglColorRenderbuffer[tt]);b.__webglDepthRenderbuffer&&i.deleteRenderbuffer(b.__webglDepthRenderbuffer)}let B=C.textures;for(let tt=0,j=B.length;tt<j;tt++){let et=n.get(B[tt]);et.__webglTexture&&(i.deleteTexture(et.__webglTexture),o.memory.textures--),n.remove(B[tt])}n.remove(C)}let A=0;function W(){A=0}function G(){let C=A;return C>=s.maxTextures&&console.warn("THREE.WebGLTextures: Trying to use "+C+" texture units while this GPU supports only "+s.maxTextures),A+=1,C}function X(C){let b=[];return b.push(C.wrapS),b.push(C.wrapT),b.push(C.wrapR||0),b.push(C.magFilter),b.push(C.minFilter),b.push(C.anisotropy),b.push(C.internalFormat),b.push(C.format),b.push(C.type),b.push(C.generateMipmaps),b.push(C.premultiplyAlpha),b.push(C.flipY),b.push(C.unpackAlignment),b.push(C.colorSpace),b.join()}function Z(C,b){let B=n.get(C);if(C.isVideoTexture&&xt(C),C.isRenderTargetTexture===!1&&C.version>0&&B.__version!==C.version){let tt=C.image;if(tt===null)console.warn("THREE.WebGLRenderer: Texture marked for update but no image data found.");else if(tt.complete===!1)console.warn("THREE.WebGLRenderer: Texture marked for update but image is incomplete");else{J(B,C,b);return}}e.bindTexture(i.TEXTURE_2D,B.__webglTexture,i.TEXTURE0+b)}function Y(C,b){let B=n.get(C);if(C.version>0&&B.__version!==C.version){J(B,C,b);return}e.bindTexture(i.TEXTURE_2D_ARRAY,B.__webglTexture,i.TEXTURE0+b)}function nt(C,b){let B=n.get(C);if(C.version>0&&B.__version!==C.version){J(B,C,b);return}e.bindTexture(i.TEXTURE_3D,B.__webglTexture,i.TEXTURE0+b)}function Q(C,b){let B=n.get(C);if(C.version>0&&B.__version!==C.version){ht(B,C,b);return}e.bindTexture(i.TEXTURE_CUBE_MAP,B.__webglTexture,i.TEXTURE0+b)}let dt={[kh]:i.REPEAT,[Qs]:i.CLAMP_TO_EDGE,[Vh]:i.MIRRORED_REPEAT},at={[bi]:i.NEAREST,[rx]:i.NEAREST_MIPMAP_NEAREST,[Ma]:i.NEAREST_MIPMAP_LINEAR,[Oi]:i.LINEAR,[Zc]:i.LINEAR_MIPMAP_NEAREST,[tr]:i.LINEAR_MIPMAP_LINEAR},_t={[cx]:i.NEVER,[mx]:i.ALWAYS,[hx]:i.LESS,[gm]:i.LEQUAL,[ux]:i.EQUAL,[px]:i.GEQUAL,[fx]:i.GREATER,[dx]:i.NOTEQUAL};function pt(C,b){if(b.type===rs&&t.has("OES_texture_float_linear")===!1&&(b.magFilter===Oi||b.magFilter===Zc||b.magFilter===Ma||b.magFilter===tr||b.minFilter===Oi||b.minFilter===Zc||b.minFilter===Ma||b.minFilter===tr)&&console.warn("THREE.WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),i.texParameteri(C,i.TEXTURE_WRAP_S,dt[b.wrapS]),i.texParameteri(C,i.TEXTURE_WRAP_T,dt[b.wrapT]),(C===i.TEXTURE_3D||C===i.TEXTURE_2D_ARRAY)&&i.texParameteri(C,i.TEXTURE_WRAP_R,dt[b.wrapR]),i.texParameteri(C,i.TEXTURE_MAG_FILTER,at[b.magFilter]),i.texParameteri(C,i.TEXTURE_MIN_FILTER,at[b.minFilter]),b.compareFunction&&(i.texParameteri(C,i.TEXTURE_COMPARE_MODE,i.COMPARE_REF_TO_TEXTURE),i.texParameteri(C,i.TEXTURE_COMPARE_FUNC,_t[b.compareFunction])),t.has("EXT_texture_filter_anisotropic")===!0){if(b.magFilter===bi||b.minFilter!==Ma&&b.minFilter!==tr||b.type===rs&&t.has("OES_texture_float_linear")===!1)return;if(b.anisotropy>1||n.get(b).__currentAnisotropy){let B=t.get("EXT_texture_filter_anisotropic");i.texParameterf(C,B.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(b.anisotropy,s.getMaxAnisotropy())),n.get(b).__currentAnisotropy=b.anisotropy}}}function Zt(C,b){let B=!1;C.__webglInit===void 0&&(C.__webglInit=!0,b.addEventListener("dispose",R));let tt=b.source,j=u.get(tt);j===void 0&&(j={},u.set(tt,j));let et=X(b);if(et!==C.__cacheKey){j[et]===void 0&&(j[et]={texture:i.createTexture(),usedTimes:0},o.memory.textures++,B=!0),j[et].usedTimes++;let Nt=j[C.__cacheKey];Nt!==void 0&&(j[C.__cacheKey].usedTimes--,Nt.usedTimes===0&&E(b)),C.__cacheKey=et,C.__webglTexture=j[et].texture}return B}function J(C,b,B){let tt=i.TEXTURE_2D;(b.isDataArrayTexture||b.isCompressedArrayTexture)&&(tt=i.TEXTURE_2D_ARRAY),b.isData3DTexture&&(tt=i.TEXTURE_3D);let j=Zt(C,b),et=b.source;e.bindTexture(tt,C.__webglTexture,i.TEXTURE0+B);let Nt=n.get(et);if(et.version!==Nt.__version||j===!0){e.activeTexture(i.TEXTURE0+B);let Mt=be.getPrimaries(be.workingColorSpace),At=b.colorSpace===Cs?null:be.getPrimaries(b.colorSpace),Kt=b.colorSpace===Cs||Mt===At?i.NONE:i.BROWSER_DEFAULT_WEBGL;i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,b.flipY),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,b.premultiplyAlpha),i.pixelStorei(i.UNPACK_ALIGNMENT,b.unpackAlignment),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,Kt);let ct=_(b.image,!1,s.maxTextureSize);ct=Jt(b,ct);let wt=r.convert(b.format,b.colorSpace),Xt=r.convert(b.type),$t=v(b.internalFormat,wt,Xt,b.colorSpace,b.isVideoTexture);pt(tt,b);let Rt,ae=b.mipmaps,ee=b.isVideoTexture!==!0,we=Nt.__version===void 0||j===!0,z=et.dataReady,Et=U(b,ct);if(b.isDepthTexture)$t=y(b.format===jr,b.type),we&&(ee?e.texStorage2D(i.TEXTURE_2D,1,$t,ct.width,ct.height):e.texImage2D(i.TEXTURE_2D,0,$t,ct.width,ct.height,0,wt,Xt,null));else if(b.isDataTexture)if(ae.length>0){ee&&we&&e.texStorage2D(i.TEXTURE_2D,Et,$t,ae[0].width,ae[0].height);for(let it=0,ot=ae.length;it<ot;it++)Rt=ae[it],ee?z&&e.texSubImage2D(i.TEXTURE_2D,it,0,0,Rt.width,Rt.height,wt,Xt,Rt.data):e.texImage2D(i.TEXTURE_2D,it,$t,Rt.width,Rt.height,0,wt,Xt,Rt.data);b.generateMipmaps=!1}else ee?(we&&e.texStorage2D(i.TEXTURE_2D,Et,$t,ct.width,ct.height),z&&e.texSubImage2D(i.TEXTURE_2D,0,0,0,ct.width,ct.height,wt,Xt,ct.data)):e.texImage2D(i.TEXTURE_2D,0,$t,ct.width,ct.height,0,wt,Xt,ct.data);else if(b.isCompressedTexture)if(b.isCompressedArrayTexture){ee&&we&&e.texStorage3D(i.TEXTURE_2D_ARRAY,Et,$t,ae[0].width,ae[0].height,ct.depth);for(let it=0,ot=ae.length;it<ot;it++)if(Rt=ae[it],b.format!==Mi)if(wt!==null)if(ee){if(z)if(b.layerUpdates.size>0){let It=kp(Rt.width,Rt.height,b.format,b.type);for(let Pt of b.layerUpdates){let se=Rt.data.subarray(Pt*It/Rt.data.BYTES_PER_ELEMENT,(Pt+1)*It/Rt.data.BYTES_PER_ELEMENT);e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,it,0,0,Pt,Rt.width,Rt.height,1,wt,se)}b.clearLayerUpdates()}else e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,it,0,0,0,Rt.width,Rt.height,ct.depth,wt,Rt.data)}else e.compressedTexImage3D(i.TEXTURE_2D_ARRAY,it,$t,Rt.width,Rt.height,ct.depth,0,Rt.data,0,0);else console.warn("THREE.WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else ee?z&&e.texSubImage3D(i.TEXTURE_2D_ARRAY,it,0,0,0,Rt.width,Rt.height,ct.depth,wt,Xt,Rt.data):e.texImage3D(i.TEXTURE_2D_ARRAY,it,$t,Rt.width,Rt.height,ct.depth,0,wt,Xt,Rt.data)}else{ee&&we&&e.texStorage2D(i.TEXTURE_2D,Et,$t,ae[0].width,ae[0].height);for(let it=0,ot=ae.length;it<ot;it++)Rt=ae[it],b.format!==Mi?wt!==null?ee?z&&e.compressedTexSubImage2D(i.TEXTURE_2D,it,0,0,Rt.width,Rt.height,wt,Rt.data):e.compressedTexImage2D(i.TEXTURE_2D,it,$t,Rt.width,Rt.height,0,Rt.data):console.warn("THREE.WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):ee?z&&e.texSubImage2D(i.TEXTURE_2D,it,0,0,Rt.width,Rt.height,wt,Xt,Rt.data):e.texImage2D(i.TEXTURE_2D,it,$t,Rt.width,Rt.height,0,wt,Xt,Rt.data)}else if(b.isDataArrayTexture)if(ee){if(we&&e.texStorage3D(i.TEXTURE_2D_ARRAY,Et,$t,ct.width,ct.height,ct.depth),z)if(b.layerUpdates.size>0){let it=kp(ct.width,ct.height,b.format,b.type);for(let ot of b.layerUpdates){let It=ct.data.subarray(ot*it/ct.data.BYTES_PER_ELEMENT,(ot+1)*it/ct.data.BYTES_PER_ELEMENT);e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,ot,ct.width,ct.height,1,wt,Xt,It)}b.clearLayerUpdates()}else e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,0,ct.width,ct.height,ct.depth,wt,Xt,ct.data)}else e.texImage3D(i.TEXTURE_2D_ARRAY,0,$t,ct.width,ct.height,ct.depth,0,wt,Xt,ct.data);else if(b.isData3DTexture)ee?(we&&e.texStorage3D(i.TEXTURE_3D,Et,$t,ct.width,ct.height,ct.depth),z&&e.texSubImage3D(i.TEXTURE_3D,0,0,0,0,ct.width,ct.height,ct.depth,wt,Xt,ct.data)):e.texImage3D(i.TEXTURE_3D,0,$t,ct.width,ct.height,ct.depth,0,wt,Xt,ct.data);else if(b.isFramebufferTexture){if(we)if(ee)e.texStorage2D(i.TEXTURE_2D,Et,$t,ct.width,ct.height);else{let it=ct.width,ot=ct.height;for(let It=0;It<Et;It++)e.texImage2D(i.TEXTURE_2D,It,$t,it,ot,0,wt,Xt,null),it>>=1,ot>>=1}}else if(ae.length>0){if(ee&&we){let it=St(ae[0]);e.texStorage2D(i.TEXTURE_2D,Et,$t,it.width,it.height)}for(let it=0,ot=ae.length;it<ot;it++)Rt=ae[it],ee?z&&e.texSubImage2D(i.TEXTURE_2D,it,0,0,wt,Xt,Rt):e.texImage2D(i.TEXTURE_2D,it,$t,wt,Xt,Rt);b.generateMipmaps=!1}else if(ee){if(we){let it=St(ct);e.texStorage2D(i.TEXTURE_2D,Et,$t,it.width,it.height)}z&&e.texSubImage2D(i.TEXTURE_2D,0,0,0,wt,Xt,ct)}else e.texImage2D(i.TEXTURE_2D,0,$t,wt,Xt,ct);g(b)&&p(tt),Nt.__version=et.version,b.onUpdate&&b.onUpdate(b)}C.__version=b.version}function ht(C,b,B){if(b.image.length!==6)return;let tt=Zt(C,b),j=b.source;e.bindTexture(i.TEXTURE_CUBE_MAP,C.__webglTexture,i.TEXTURE0+B);let et=n.get(j);if(j.version!==et.__version||tt===!0){e.activeTexture(i.TEXTURE0+B);let Nt=be.getPrimaries(be.workingColorSpace),Mt=b.colorSpace===Cs?null:be.getPrimaries(b.colorSpace),At=b.colorSpace===Cs||Nt===Mt?i.NONE:i.BROWSER_DEFAULT_WEBGL;i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,b.flipY),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,b.premultiplyAlpha),i.pixelStorei(i.UNPACK_ALIGNMENT,b.unpackAlignment),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,At);let Kt=b.isCompressedTexture||b.image[0].isCompressedTexture,ct=b.image[0]&&b.image[0].isDataTexture,wt=[];for(let ot=0;ot<6;ot++)!Kt&&!ct?wt[ot]=_(b.image[ot],!0,s.maxCubemapSize):wt[ot]=ct?b.image[ot].image:b.image[ot],wt[ot]=Jt(b,wt[ot]);let Xt=wt[0],$t=r.convert(b.format,b.colorSpace),Rt=r.convert(b.type),ae=v(b.internalFormat,$t,Rt,b.colorSpace),ee=b.isVideoTexture!==!0,we=et.__version===void 0||tt===!0,z=j.dataReady,Et=U(b,Xt);pt(i.TEXTURE_CUBE_MAP,b);let it;if(Kt){ee&&we&&e.texStorage2D(i.TEXTURE_CUBE_MAP,Et,ae,Xt.width,Xt.height);for(let ot=0;ot<6;ot++){it=wt[ot].mipmaps;for(let It=0;It<it.length;It++){let Pt=it[It];b.format!==Mi?$t!==null?ee?z&&e.compressedTexSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It,0,0,Pt.width,Pt.height,$t,Pt.data):e.compressedTexImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It,ae,Pt.width,Pt.height,0,Pt.data):console.warn("THREE.WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):ee?z&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It,0,0,Pt.width,Pt.height,$t,Rt,Pt.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It,ae,Pt.width,Pt.height,0,$t,Rt,Pt.data)}}}else{if(it=b.mipmaps,ee&&we){it.length>0&&Et++;let ot=St(wt[0]);e.texStorage2D(i.TEXTURE_CUBE_MAP,Et,ae,ot.width,ot.height)}for(let ot=0;ot<6;ot++)if(ct){ee?z&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,0,0,0,wt[ot].width,wt[ot].height,$t,Rt,wt[ot].data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,0,ae,wt[ot].width,wt[ot].height,0,$t,Rt,wt[ot].data);for(let It=0;It<it.length;It++){let se=it[It].image[ot].image;ee?z&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It+1,0,0,se.width,se.height,$t,Rt,se.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It+1,ae,se.width,se.height,0,$t,Rt,se.data)}}else{ee?z&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,0,0,0,$t,Rt,wt[ot]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,0,ae,$t,Rt,wt[ot]);for(let It=0;It<it.length;It++){let Pt=it[It];ee?z&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It+1,0,0,$t,Rt,Pt.image[ot]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+ot,It+1,ae,$t,Rt,Pt.image[ot])}}}g(b)&&p(i.TEXTURE_CUBE_MAP),et.__version=j.version,b.onUpdate&&b.onUpdate(b)}C.__version=b.version}function Ot(C,b,B,tt,j,et){let Nt=r.convert(B.format,B.colorSpace),Mt=r.convert(B.type),At=v(B.internalFormat,Nt,Mt,B.colorSpace),Kt=n.get(b),ct=n.get(B);if(ct.__renderTarget=b,!Kt.__hasExternalTextures){let wt=Math.max(1,b.width>>et),Xt=Math.max(1,b.height>>et);j===i.TEXTURE_3D||j===i.TEXTURE_2D_ARRAY?e.texImage3D(j,et,At,wt,Xt,b.depth,0,Nt,Mt,null):e.texImage2D(j,et,At,wt,Xt,0,Nt,Mt,null)}e.bindFramebuffer(i.FRAMEBUFFER,C),Tt(b)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,tt,j,ct.__webglTexture,0,ut(b)):(j===i.TEXTURE_2D||j>=i.TEXTURE_CUBE_MAP_POSITIVE_X&&j<=i.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&i.framebufferTexture2D(i.FRAMEBUFFER,tt,j,ct.__webglTexture,et),e.bindFramebuffer(i.FRAMEBUFFER,null)}function lt(C,b,B){if(i.bindRenderbuffer(i.RENDERBUFFER,C),b.depthBuffer){let tt=b.depthTexture,j=tt&&tt.isDepthTexture?tt.type:null,et=y(b.stencilBuffer,j),Nt=b.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,Mt=ut(b);Tt(b)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,Mt,et,b.width,b.height):B?i.renderbufferStorageMultisample(i.RENDERBUFFER,Mt,et,b.width,b.height):i.renderbufferStorage(i.RENDERBUFFER,et,b.width,b.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,Nt,i.RENDERBUFFER,C)}else{let tt=b.textures;for(let j=0;j<tt.length;j++){let et=tt[j],Nt=r.convert(et.format,et.colorSpace),Mt=r.convert(et.type),At=v(et.internalFormat,Nt,Mt,et.colorSpace),Kt=ut(b);B&&Tt(b)===!1?i.renderbufferStorageMultisample(i.RENDERBUFFER,Kt,At,b.width,b.height):Tt(b)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,Kt,At,b.width,b.height):i.renderbufferStorage(i.RENDERBUFFER,At,b.width,b.height)}}i.bindRenderbuffer(i.RENDERBUFFER,null)}function Ft(C,b){if(b&&b.isWebGLCubeRenderTarget)throw new Error("Depth Texture with cube render targets is not supported");if(e.bindFramebuffer(i.FRAMEBUFFER,C),!(b.depthTexture&&b.depthTexture.isDepthTexture))throw new Error("renderTarget.depthTexture must be an instance of THREE.DepthTexture");let tt=n.get(b.depthTexture);tt.__renderTarget=b,(!tt.__webglTexture||b.depthTexture.image.width!==b.width||b.depthTexture.image.height!==b.height)&&(b.depthTexture.image.width=b.width,b.depthTexture.image.height=b.height,b.depthTexture.needsUpdate=!0),Z(b.depthTexture,0);let j=tt.__webglTexture,et=ut(b);if(b.depthTexture.format===Wr)Tt(b)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,i.DEPTH_ATTACHMENT,i.TEXTURE_2D,j,0,et):i.framebufferTexture2D(i.FRAMEBUFFER,i.DEPTH_ATTACHMENT,i.TEXTURE_2D,j,0);else if(b.depthTexture.format===jr)Tt(b)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,i.DEPTH_STENCIL_ATTACHMENT,i.TEXTURE_2D,j,0,et):i.framebufferTexture2D(i.FRAMEBUFFER,i.DEPTH_STENCIL_ATTACHMENT,i.TEXTURE_2D,j,0);else throw new Error("Unknown depthTexture format")}function Yt(C){let b=n.get(C),B=C.isWebGLCubeRenderTarget===!0;if(b.__boundDepthTexture!==C.depthTexture){let tt=C.depthTexture;if(b.__depthDisposeCallback&&b.__depthDisposeCallback(),tt){let j=()=>{delete b.__boundDepthTexture,delete b.__depthDisposeCallback,tt.removeEventListener("dispose",j)};tt.addEventListener("dispose",j),b.__depthDisposeCallback=j}b.__boundDepthTexture=tt}if(C.depthTexture&&!b.__autoAllocateDepthBuffer){if(B)throw new Error("target.depthTexture not supported in Cube render targets");Ft(b.__webglFramebuffer,C)}else if(B){b.__webglDepthbuffer=[];for(let tt=0;tt<6;tt++)if(e.bindFramebuffer(i.FRAMEBUFFER,b.__webglFramebuffer[tt]),b.__webglDepthbuffer[tt]===void 0)b.__webglDepthbuffer[tt]=i.createRenderbuffer(),lt(b.__webglDepthbuffer[tt],C,!1);else{let j=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,et=b.__webglDepthbuffer[tt];i.bindRenderbuffer(i.RENDERBUFFER,et),i.framebufferRenderbuffer(i.FRAMEBUFFER,j,i.RENDERBUFFER,et)}}else if(e.bindFramebuffer(i.FRAMEBUFFER,b.__webglFramebuffer),b.__webglDepthbuffer===void 0)b.__webglDepthbuffer=i.createRenderbuffer(),lt(b.__webglDepthbuffer,C,!1);else{let tt=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,j=b.__webglDepthbuffer;i.bindRenderbuffer(i.RENDERBUFFER,j),i.framebufferRenderbuffer(i.FRAMEBUFFER,tt,i.RENDERBUFFER,j)}e.bindFramebuffer(i.FRAMEBUFFER,null)}function Ut(C,b,B){let tt=n.get(C);b!==void 0&&Ot(tt.__webglFramebuffer,C,C.texture,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,0),B!==void 0&&Yt(C)}function te(C){let b=C.texture,B=n.get(C),tt=n.get(b);C.addEventListener("dispose",P);let j=C.textures,et=C.isWebGLCubeRenderTarget===!0,Nt=j.length>1;if(Nt||(tt.__webglTexture===void 0&&(tt.__webglTexture=i.createTexture()),tt.__version=b.version,o.memory.textures++),et){B.__webglFramebuffer=[];for(let Mt=0;Mt<6;Mt++)if(b.mipmaps&&b.mipmaps.length>0){B.__webglFramebuffer[Mt]=[];for(let At=0;At<b.mipmaps.length;At++)B.__webglFramebuffer[Mt][At]=i.createFramebuffer()}else B.__webglFramebuffer[Mt]=i.createFramebuffer()}else{if(b.mipmaps&&b.mipmaps.length>0){B.__webglFramebuffer=[];for(let Mt=0;Mt<b.mipmaps.length;Mt++)B.__webglFramebuffer[Mt]=i.createFramebuffer()}else B.__webglFramebuffer=i.createFramebuffer();if(Nt)for(let Mt=0,At=j.length;Mt<At;Mt++){let Kt=n.get(j[Mt]);Kt.__webglTexture===void 0&&(Kt.__webglTexture=i.createTexture(),o.memory.textures++)}if(C.samples>0&&Tt(C)===!1){B.__webglMultisampledFramebuffer=i.createFramebuffer(),B.__webglColorRenderbuffer=[],e.bindFramebuffer(i.FRAMEBUFFER,B.__webglMultisampledFramebuffer);for(let Mt=0;Mt<j.length;Mt++){let At=j[Mt];B.__webglColorRenderbuffer[Mt]=i.createRenderbuffer(),i.bindRenderbuffer(i.RENDERBUFFER,B.__webglColorRenderbuffer[Mt]);let Kt=r.convert(At.format,At.colorSpace),ct=r.convert(At.type),wt=v(At.internalFormat,Kt,ct,At.colorSpace,C.isXRRenderTarget===!0),Xt=ut(C);i.renderbufferStorageMultisample(i.RENDERBUFFER,Xt,wt,C.width,C.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+Mt,i.RENDERBUFFER,B.__webglColorRenderbuffer[Mt])}i.bindRenderbuffer(i.RENDERBUFFER,null),C.depthBuffer&&(B.__webglDepthRenderbuffer=i.createRenderbuffer(),lt(B.__webglDepthRenderbuffer,C,!0)),e.bindFramebuffer(i.FRAMEBUFFER,null)}}if(et){e.bindTexture(i.TEXTURE_CUBE_MAP,tt.__webglTexture),pt(i.TEXTURE_CUBE_MAP,b);for(let Mt=0;Mt<6;Mt++)if(b.mipmaps&&b.mipmaps.length>0)for(let At=0;At<b.mipmaps.length;At++)Ot(B.__webglFramebuffer[Mt][At],C,b,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+Mt,At);else Ot(B.__webglFramebuffer[Mt],C,b,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+Mt,0);g(b)&&p(i.TEXTURE_CUBE_MAP),e.unbindTexture()}else if(Nt){for(let Mt=0,At=j.length;Mt<At;Mt++){let Kt=j[Mt],ct=n.get(Kt);e.bindTexture(i.TEXTURE_2D,ct.__webglTexture),pt(i.TEXTURE_2D,Kt),Ot(B.__webglFramebuffer,C,Kt,i.COLOR_ATTACHMENT0+Mt,i.TEXTURE_2D,0),g(Kt)&&p(i.TEXTURE_2D)}e.unbindTexture()}else{let Mt=i.TEXTURE_2D;if((C.isWebGL3DRenderTarget||C.isWebGLArrayRenderTarget)&&(Mt=C.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(Mt,tt.__webglTexture),pt(Mt,b),b.mipmaps&&b.mipmaps.length>0)for(let At=0;At<b.mipmaps.length;At++)Ot(B.__webglFramebuffer[At],C,b,i.COLOR_ATTACHMENT0,Mt,At);else Ot(B.__webglFramebuffer,C,b,i.COLOR_ATTACHMENT0,Mt,0);g(b)&&p(Mt),e.unbindTexture()}C.depthBuffer&&Yt(C)}function st(C){let b=C.textures;for(let B=0,tt=b.length;B<tt;B++){let j=b[B];if(g(j)){let et=S(C),Nt=n.get(j).__webglTexture;e.bindTexture(et,Nt),p(et),e.unbindTexture()}}}let mt=[],N=[];function Vt(C){if(C.samples>0){if(Tt(C)===!1){let b=C.textures,B=C.width,tt=C.height,j=i.COLOR_BUFFER_BIT,et=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,Nt=n.get(C),Mt=b.length>1;if(Mt)for(let At=0;At<b.length;At++)e.bindFramebuffer(i.FRAMEBUFFER,Nt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+At,i.RENDERBUFFER,null),e.bindFramebuffer(i.FRAMEBUFFER,Nt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+At,i.TEXTURE_2D,null,0);e.bindFramebuffer(i.READ_FRAMEBUFFER,Nt.__webglMultisampledFramebuffer),e.bindFramebuffer(i.DRAW_FRAMEBUFFER,Nt.__webglFramebuffer);for(let At=0;At<b.length;At++){if(C.resolveDepthBuffer&&(C.depthBuffer&&(j|=i.DEPTH_BUFFER_BIT),C.stencilBuffer&&C.resolveStencilBuffer&&(j|=i.STENCIL_BUFFER_BIT)),Mt){i.framebufferRenderbuffer(i.READ_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.RENDERBUFFER,Nt.__webglColorRenderbuffer[At]);let Kt=n.get(b[At]).__webglTexture;i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,Kt,0)}i.blitFramebuffer(0,0,B,tt,0,0,B,tt,j,i.NEAREST),l===!0&&(mt.length=0,N.length=0,mt.push(i.COLOR_ATTACHMENT0+At),C.depthBuffer&&C.resolveDepthBuffer===!1&&(mt.push(et),N.push(et),i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,N)),i.invalidateFramebuffer(i.READ_FRAMEBUFFER,mt))}if(e.bindFramebuffer(i.READ_FRAMEBUFFER,null),e.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),Mt)for(let At=0;At<b.length;At++){e.bindFramebuffer(i.FRAMEBUFFER,Nt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+At,i.RENDERBUFFER,Nt.__webglColorRenderbuffer[At]);let Kt=n.get(b[At]).__webglTexture;e.bindFramebuffer(i.FRAMEBUFFER,Nt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+At,i.TEXTURE_2D,Kt,0)}e.bindFramebuffer(i.DRAW_FRAMEBUFFER,Nt.__webglMultisampledFramebuffer)}else if(C.depthBuffer&&C.resolveDepthBuffer===!1&&l){let b=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,[b])}}}function ut(C){return Math.min(s.maxSamples,C.samples)}function Tt(C){let b=n.get(C);return C.samples>0&&t.has("WEBGL_multisampled_render_to_texture")===!0&&b.__useRenderToTexture!==!1}function xt(C){let b=o.render.frame;h.get(C)!==b&&(h.set(C,b),C.update())}function Jt(C,b){let B=C.colorSpace,tt=C.format,j=C.type;return C.isCompressedTexture===!0||C.isVideoTexture===!0||B!==ro&&B!==Cs&&(be.getTransfer(B)===Le?(tt!==Mi||j!==ls)&&console.warn("THREE.WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):console.error("THREE.WebGLTextures: Unsupported texture color space:",B)),b}function St(C){return typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement?(c.width=C.naturalWidth||C.width,c.height=C.naturalHeight||C.height):typeof VideoFrame<"u"&&C instanceof VideoFrame?(c.width=C.displayWidth,c.height=C.displayHeight):(c.width=C.width,c.height=C.height),c}this.allocateTextureUnit=G,this.resetTextureUnits=W,this.setTexture2D=Z,this.setTexture2DArray=Y,this.setTexture3D=nt,this.setTextureCube=Q,this.rebindTextures=Ut,this.setupRenderTarget=te,this.updateRenderTargetMipmap=st,this.updateMultisampleRenderTarget=Vt,this.setupDepthRenderbuffer=Yt,this.setupFrameBufferTexture=Ot,this.useMultisampledRTT=Tt}function MS(i,t){function e(n,s=Cs){let r,o=be.getTransfer(s);if(n===ls)return i.UNSIGNED_BYTE;if(n===of)return i.UNSIGNED_SHORT_4_4_4_4;if(n===af)return i.UNSIGNED_SHORT_5_5_5_1;if(n===rm)return i.UNSIGNED_INT_5_9_9_9_REV;if(n===im)return i.BYTE;if(n===sm)return i.SHORT;if(n===Bo)return i.UNSIGNED_SHORT;if(n===rf)return i.INT;if(n===er)return i.UNSIGNED_INT;if(n===rs)return i.FLOAT;if(n===Yo)return i.HALF_FLOAT;if(n===om)return i.ALPHA;if(n===am)return i.RGB;if(n===Mi)return i.RGBA;if(n===lm)return i.LUMINANCE;if(n===cm)return i.LUMINANCE_ALPHA;if(n===Wr)return i.DEPTH_COMPONENT;if(n===jr)return i.DEPTH_STENCIL;if(n===hm)return i.RED;if(n===lf)return i.RED_INTEGER;if(n===um)return i.RG;if(n===cf)return i.RG_INTEGER;if(n===hf)return i.RGBA_INTEGER;if(n===ja||n===Qa||n===tl||n===el)if(o===Le)if(r=t.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===ja)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===Qa)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===tl)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===el)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=t.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===ja)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===Qa)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===tl)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===el)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===Hh||n===Gh||n===Wh||n===Xh)if(r=t.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===Hh)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===Gh)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===Wh)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===Xh)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===qh||n===Yh||n===$h)if(r=t.get("WEBGL_compressed_texture_etc"),r!==null){if(n===qh||n===Yh)return o===Le?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===$h)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC}else return null;if(n===Zh||n===Jh||n===Kh||n===jh||n===Qh||n===tu||n===eu||n===nu||n===iu||n===su||n===ru||n===ou||n===au||n===lu)if(r=t.get("WEBGL_compressed_texture_astc"),r!==null){if(n===Zh)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===Jh)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===Kh)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===jh)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===Qh)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===tu)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===eu)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===nu)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===iu)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===su)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===ru)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===ou)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===au)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===lu)return o===Le?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===nl||n===cu||n===hu)if(r=t.get("EXT_texture_compression_bptc"),r!==null){if(n===nl)return o===Le?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===cu)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===hu)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===fm||n===uu||n===fu||n===du)if(r=t.get("EXT_texture_compression_rgtc"),r!==null){if(n===nl)return r.COMPRESSED_RED_RGTC1_EXT;if(n===uu)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===fu)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===du)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===Kr?i.UNSIGNED_INT_24_8:i[n]!==void 0?i[n]:null}return{convert:e}}var Ru=class extends Un{constructor(t=[]){super(),this.isArrayCamera=!0,this.cameras=t}},Be=class extends En{constructor(){super(),this.isGroup=!0,this.type="Group"}},bS={type:"move"},No=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new Be,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new Be,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new D,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new D),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new Be,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new D,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new D),this._grip}dispatchEvent(t){return this._targetRay!==null&&this._targetRay.dispatchEvent(t),this._grip!==null&&this._grip.dispatchEvent(t),this._hand!==null&&this._hand.dispatchEvent(t),this}connect(t){if(t&&t.hand){let e=this._hand;if(e)for(let n of t.hand.values())this._getHandJoint(e,n)}return this.dispatchEvent({type:"connected",data:t}),this}disconnect(t){return this.dispatchEvent({type:"disconnected",data:t}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(t,e,n){let s=null,r=null,o=null,a=this._targetRay,l=this._grip,c=this._hand;if(t&&e.session.visibilityState!=="visible-blurred"){if(c&&t.hand){o=!0;for(let _ of t.hand.values()){let g=e.getJointPose(_,n),p=this._getHandJoint(c,_);g!==null&&(p.matrix.fromArray(g.transform.matrix),p.matrix.decompose(p.position,p.rotation,p.scale),p.matrixWorldNeedsUpdate=!0,p.jointRadius=g.radius),p.visible=g!==null}let h=c.joints["index-finger-tip"],f=c.joints["thumb-tip"],u=h.position.distanceTo(f.position),d=.02,m=.005;c.inputState.pinching&&u>d+m?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:t.handedness,target:this})):!c.inputState.pinching&&u<=d-m&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:t.handedness,target:this}))}else l!==null&&t.gripSpace&&(r=e.getPose(t.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.rotation,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1));a!==null&&(s=e.getPose(t.targetRaySpace,n),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.rotation,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(bS)))}return a!==null&&(a.visible=s!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=o!==null),this}_getHandJoint(t,e){if(t.joints[e.jointName]===void 0){let n=new Be;n.matrixAutoUpdate=!1,n.visible=!1,t.joints[e.jointName]=n,t.add(n)}return t.joints[e.jointName]}},SS=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,wS=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,Pu=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(t,e,n){if(this.texture===null){let s=new oi,r=t.properties.get(s);r.__webglTexture=e.texture,(e.depthNear!=n.depthNear||e.depthFar!=n.depthFar)&&(this.depthNear=e.depthNear,this.depthFar=e.depthFar),this.texture=s}}getMesh(t){if(this.texture!==null&&this.mesh===null){let e=t.cameras[0].viewport,n=new ai({vertexShader:SS,fragmentShader:wS,uniforms:{depthColor:{value:this.texture},depthWidth:{value:e.z},depthHeight:{value:e.w}}});this.mesh=new xe(new to(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},Iu=class extends cs{constructor(t,e){super();let n=this,s=null,r=1,o=null,a="local-floor",l=1,c=null,h=null,f=null,u=null,d=null,m=null,_=new Pu,g=e.getContextAttributes(),p=null,S=null,v=[],y=[],U=new gt,R=null,P=new Un;P.viewport=new De;let F=new Un;F.viewport=new De;let E=[P,F],M=new Ru,A=null,W=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(J){let ht=v[J];return ht===void 0&&(ht=new No,v[J]=ht),ht.getTargetRaySpace()},this.getControllerGrip=function(J){let ht=v[J];return ht===void 0&&(ht=new No,v[J]=ht),ht.getGripSpace()},this.getHand=function(J){let ht=v[J];return ht===void 0&&(ht=new No,v[J]=ht),ht.getHandSpace()};function G(J){let ht=y.indexOf(J.inputSource);if(ht===-1)return;let Ot=v[ht];Ot!==void 0&&(Ot.update(J.inputSource,J.frame,c||o),Ot.dispatchEvent({type:J.type,data:J.inputSource}))}function X(){s.removeEventListener("select",G),s.removeEventListener("selectstart",G),s.removeEventListener("selectend",G),s.removeEventListener("squeeze",G),s.removeEventListener("squeezestart",G),s.removeEventListener("squeezeend",G),s.removeEventListener("end",X),s.removeEventListener("inputsourceschange",Z);for(let J=0;J<v.length;J++){let ht=y[J];ht!==null&&(y[J]=null,v[J].disconnect(ht))}A=null,W=null,_.reset(),t.setRenderTarget(p),d=null,u=null,f=null,s=null,S=null,Zt.stop(),n.isPresenting=!1,t.setPixelRatio(R),t.setSize(U.width,U.height,!1),n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(J){r=J,n.isPresenting===!0&&console.warn("THREE.WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(J){a=J,n.isPresenting===!0&&console.warn("THREE.WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||o},this.setReferenceSpace=function(J){c=J},this.getBaseLayer=function(){return u!==null?u:d},this.getBinding=function(){return f},this.getFrame=function(){return m},this.getSession=function(){return s},this.setSession=async function(J){if(s=J,s!==null){if(p=t.getRenderTarget(),s.addEventListener("select",G),s.addEventListener("selectstart",G),s.addEventListener("selectend",G),s.addEventListener("squeeze",G),s.addEventListener("squeezestart",G),s.addEventListener("squeezeend",G),s.addEventListener("end",X),s.addEventListener("inputsourceschange",Z),g.xrCompatible!==!0&&await e.makeXRCompatible(),R=t.getPixelRatio(),t.getSize(U),s.renderState.layers===void 0){let ht={antialias:g.antialias,alpha:!0,depth:g.depth,stencil:g.stencil,framebufferScaleFactor:r};d=new XRWebGLLayer(s,e,ht),s.updateRenderState({baseLayer:d}),t.setPixelRatio(1),t.setSize(d.framebufferWidth,d.framebufferHeight,!1),S=new hs(d.framebufferWidth,d.framebufferHeight,{format:Mi,type:ls,colorSpace:t.outputColorSpace,stencilBuffer:g.stencil})}else{let ht=null,Ot=null,lt=null;g.depth&&(lt=g.stencil?e.DEPTH24_STENCIL8:e.DEPTH_COMPONENT24,ht=g.stencil?jr:Wr,Ot=g.stencil?Kr:er);let Ft={colorFormat:e.RGBA8,depthFormat:lt,scaleFactor:r};f=new XRWebGLBinding(s,e),u=f.createProjectionLayer(Ft),s.updateRenderState({layers:[u]}),t.setPixelRatio(1),t.setSize(u.textureWidth,u.textureHeight,!1),S=new hs(u.textureWidth,u.textureHeight,{format:Mi,type:ls,depthTexture:new dl(u.textureWidth,u.textureHeight,Ot,void 0,void 0,void 0,void 0,void 0,void 0,ht),stencilBuffer:g.stencil,colorSpace:t.outputColorSpace,samples:g.antialias?4:0,resolveDepthBuffer:u.ignoreDepthValues===!1})}S.isXRRenderTarget=!0,this.setFoveation(l),c=null,o=await s.requestReferenceSpace(a),Zt.setContext(s),Zt.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return _.getDepthTexture()};function Z(J){for(let ht=0;ht<J.removed.length;ht++){let Ot=J.removed[ht],lt=y.indexOf(Ot);lt>=0&&(y[lt]=null,v[lt].disconnect(Ot))}for(let ht=0;ht<J.added.length;ht++){let Ot=J.added[ht],lt=y.indexOf(Ot);if(lt===-1){for(let Yt=0;Yt<v.length;Yt++)if(Yt>=y.length){y.push(Ot),lt=Yt;break}else if(y[Yt]===null){y[Yt]=Ot,lt=Yt;break}if(lt===-1)break}let Ft=v[lt];Ft&&Ft.connect(Ot)}}let Y=new D,nt=new D;function Q(J,ht,Ot){Y.setFromMatrixPosition(ht.matrixWorld),nt.setFromMatrixPosition(Ot.matrixWorld);let lt=Y.distanceTo(nt),Ft=ht.projectionMatrix.elements,Yt=Ot.projectionMatrix.elements,Ut=Ft[14]/(Ft[10]-1),te=Ft[14]/(Ft[10]+1),st=(Ft[9]+1)/Ft[5],mt=(Ft[9]-1)/Ft[5],N=(Ft[8]-1)/Ft[0],Vt=(Yt[8]+1)/Yt[0],ut=Ut*N,Tt=Ut*Vt,xt=lt/(-N+Vt),Jt=xt*-N;if(ht.matrixWorld.decompose(J.position,J.quaternion,J.scale),J.translateX(Jt),J.translateZ(xt),J.matrixWorld.compose(J.position,J.quaternion,J.scale),J.matrixWorldInverse.copy(J.matrixWorld).invert(),Ft[10]===-1)J.projectionMatrix.copy(ht.projectionMatrix),J.projectionMatrixInverse.copy(ht.projectionMatrixInverse);else{let St=Ut+xt,C=te+xt,b=ut-Jt,B=Tt+(lt-Jt),tt=st*te/C*St,j=mt*te/C*St;J.projectionMatrix.makePerspective(b,B,tt,j,St,C),J.projectionMatrixInverse.copy(J.projectionMatrix).invert()}}function dt(J,ht){ht===null?J.matrixWorld.copy(J.matrix):J.matrixWorld.multiplyMatrices(ht.matrixWorld,J.matrix),J.matrixWorldInverse.copy(J.matrixWorld).invert()}this.updateCamera=function(J){if(s===null)return;let ht=J.near,Ot=J.far;_.texture!==null&&(_.depthNear>0&&(ht=_.depthNear),_.depthFar>0&&(Ot=_.depthFar)),M.near=F.near=P.near=ht,M.far=F.far=P.far=Ot,(A!==M.near||W!==M.far)&&(s.updateRenderState({depthNear:M.near,depthFar:M.far}),A=M.near,W=M.far),P.layers.mask=J.layers.mask|2,F.layers.mask=J.layers.mask|4,M.layers.mask=P.layers.mask|F.layers.mask;let lt=J.parent,Ft=M.cameras;dt(M,lt);for(let Yt=0;Yt<Ft.length;Yt++)dt(Ft[Yt],lt);Ft.length===2?Q(M,P,F):M.projectionMatrix.copy(P.projectionMatrix),at(J,M,lt)};function at(J,ht,Ot){Ot===null?J.matrix.copy(ht.matrixWorld):(J.matrix.copy(Ot.matrixWorld),J.matrix.invert(),J.matrix.multiply(ht.matrixWorld)),J.matrix.decompose(J.position,J.quaternion,J.scale),J.updateMatrixWorld(!0),J.projectionMatrix.copy(ht.projectionMatrix),J.projectionMatrixInverse.copy(ht.projectionMatrixInverse),J.isPerspectiveCamera&&(J.fov=zo*2*Math.atan(1/J.projectionMatrix.elements[5]),J.zoom=1)}this.getCamera=function(){return M},this.getFoveation=function(){if(!(u===null&&d===null))return l},this.setFoveation=function(J){l=J,u!==null&&(u.fixedFoveation=J),d!==null&&d.fixedFoveation!==void 0&&(d.fixedFoveation=J)},this.hasDepthSensing=function(){return _.texture!==null},this.getDepthSensingMesh=function(){return _.getMesh(M)};let _t=null;function pt(J,ht){if(h=ht.getViewerPose(c||o),m=ht,h!==null){let Ot=h.views;d!==null&&(t.setRenderTargetFramebuffer(S,d.framebuffer),t.setRenderTarget(S));let lt=!1;Ot.length!==M.cameras.length&&(M.cameras.length=0,lt=!0);for(let Yt=0;Yt<Ot.length;Yt++){let Ut=Ot[Yt],te=null;if(d!==null)te=d.getViewport(Ut);else{let mt=f.getViewSubImage(u,Ut);te=mt.viewport,Yt===0&&(t.setRenderTargetTextures(S,mt.colorTexture,u.ignoreDepthValues?void 0:mt.depthStencilTexture),t.setRenderTarget(S))}let st=E[Yt];st===void 0&&(st=new Un,st.layers.enable(Yt),st.viewport=new De,E[Yt]=st),st.matrix.fromArray(Ut.transform.matrix),st.matrix.decompose(st.position,st.quaternion,st.scale),st.projectionMatrix.fromArray(Ut.projectionMatrix),st.projectionMatrixInverse.copy(st.projectionMatrix).invert(),st.viewport.set(te.x,te.y,te.width,te.height),Yt===0&&(M.matrix.copy(st.matrix),M.matrix.decompose(M.position,M.quaternion,M.scale)),lt===!0&&M.cameras.push(st)}let Ft=s.enabledFeatures;if(Ft&&Ft.includes("depth-sensing")){let Yt=f.getDepthInformation(Ot[0]);Yt&&Yt.isValid&&Yt.texture&&_.init(t,Yt,s.renderState)}}for(let Ot=0;Ot<v.length;Ot++){let lt=y[Ot],Ft=v[Ot];lt!==null&&Ft!==void 0&&Ft.update(lt,ht,c||o)}_t&&_t(J,ht),ht.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:ht}),m=null}let Zt=new vm;Zt.setAnimationLoop(pt),this.setAnimationLoop=function(J){_t=J},this.dispose=function(){}}},Zs=new ki,ES=new ze;function TS(i,t){function e(g,p){g.matrixAutoUpdate===!0&&g.updateMatrix(),p.value.copy(g.matrix)}function n(g,p){p.color.getRGB(g.fogColor.value,ym(i)),p.isFog?(g.fogNear.value=p.near,g.fogFar.value=p.far):p.isFogExp2&&(g.fogDensity.value=p.density)}function s(g,p,S,v,y){p.isMeshBasicMaterial||p.isMeshLambertMaterial?r(g,p):p.isMeshToonMaterial?(r(g,p),f(g,p)):p.isMeshPhongMaterial?(r(g,p),h(g,p)):p.isMeshStandardMaterial?(r(g,p),u(g,p),p.isMeshPhysicalMaterial&&d(g,p,y)):p.isMeshMatcapMaterial?(r(g,p),m(g,p)):p.isMeshDepthMaterial?r(g,p):p.isMeshDistanceMaterial?(r(g,p),_(g,p)):p.isMeshNormalMaterial?r(g,p):p.isLineBasicMaterial?(o(g,p),p.isLineDashedMaterial&&a(g,p)):p.isPointsMaterial?l(g,p,S,v):p.isSpriteMaterial?c(g,p):p.isShadowMaterial?(g.color.value.copy(p.color),g.opacity.value=p.opacity):p.isShaderMaterial&&(p.uniformsNeedUpdate=!1)}function r(g,p){g.opacity.value=p.opacity,p.color&&g.diffuse.value.copy(p.color),p.emissive&&g.emissive.value.copy(p.emissive).multiplyScalar(p.emissiveIntensity),p.map&&(g.map.value=p.map,e(p.map,g.mapTransform)),p.alphaMap&&(g.alphaMap.value=p.alphaMap,e(p.alphaMap,g.alphaMapTransform)),p.bumpMap&&(g.bumpMap.value=p.bumpMap,e(p.bumpMap,g.bumpMapTransform),g.bumpScale.value=p.bumpScale,p.side===zn&&(g.bumpScale.value*=-1)),p.normalMap&&(g.normalMap.value=p.normalMap,e(p.normalMap,g.normalMapTransform),g.normalScale.value.copy(p.normalScale),p.side===zn&&g.normalScale.value.negate()),p.displacementMap&&(g.displacementMap.value=p.displacementMap,e(p.displacementMap,g.displacementMapTransform),g.displacementScale.value=p.displacementScale,g.displacementBias.value=p.displacementBias),p.emissiveMap&&(g.emissiveMap.value=p.emissiveMap,e(p.emissiveMap,g.emissiveMapTransform)),p.specularMap&&(g.specularMap.value=p.specularMap,e(p.specularMap,g.specularMapTransform)),p.alphaTest>0&&(g.alphaTest.value=p.alphaTest);let S=t.get(p),v=S.envMap,y=S.envMapRotation;v&&(g.envMap.value=v,Zs.copy(y),Zs.x*=-1,Zs.y*=-1,Zs.z*=-1,v.isCubeTexture&&v.isRenderTargetTexture===!1&&(Zs.y*=-1,Zs.z*=-1),g.envMapRotation.value.setFromMatrix4(ES.makeRotationFromEuler(Zs)),g.flipEnvMap.value=v.isCubeTexture&&v.isRenderTargetTexture===!1?-1:1,g.reflectivity.value=p.reflectivity,g.ior.value=p.ior,g.refractionRatio.value=p.refractionRatio),p.lightMap&&(g.lightMap.value=p.lightMap,g.lightMapIntensity.value=p.lightMapIntensity,e(p.lightMap,g.lightMapTransform)),p.aoMap&&(g.aoMap.value=p.aoMap,g.aoMapIntensity.value=p.aoMapIntensity,e(p.aoMap,g.aoMapTransform))}function o(g,p){g.diffuse.value.copy(p.color),g.opacity.value=p.opacity,p.map&&(g.map.value=p.map,e(p.map,g.mapTransform))}function a(g,p){g.dashSize.value=p.dashSize,g.totalSize.value=p.dashSize+p.gapSize,g.scale.value=p.scale}function l(g,p,S,v){g.diffuse.value.copy(p.color),g.opacity.value=p.opacity,g.size.value=p.size*S,g.scale.value=v*.5,p.map&&(g.map.value=p.map,e(p.map,g.uvTransform)),p.alphaMap&&(g.alphaMap.value=p.alphaMap,e(p.alphaMap,g.alphaMapTransform)),p.alphaTest>0&&(g.alphaTest.value=p.alphaTest)}function c(g,p){g.diffuse.value.copy(p.color),g.opacity.value=p.opacity,g.rotation.value=p.rotation,p.map&&(g.map.value=p.map,e(p.map,g.mapTransform)),p.alphaMap&&(g.alphaMap.value=p.alphaMap,e(p.alphaMap,g.alphaMapTransform)),p.alphaTest>0&&(g.alphaTest.value=p.alphaTest)}function h(g,p){g.specular.value.copy(p.specular),g.shininess.value=Math.max(p.shininess,1e-4)}function f(g,p){p.gradientMap&&(g.gradientMap.value=p.gradientMap)}function u(g,p){g.metalness.value=p.metalness,p.metalnessMap&&(g.metalnessMap.value=p.metalnessMap,e(p.metalnessMap,g.metalnessMapTransform)),g.roughness.value=p.roughness,p.roughnessMap&&(g.roughnessMap.value=p.roughnessMap,e(p.roughnessMap,g.roughnessMapTransform)),p.envMap&&(g.envMapIntensity.value=p.envMapIntensity)}function d(g,p,S){g.ior.value=p.ior,p.sheen>0&&(g.sheenColor.value.copy(p.sheenColor).multiplyScalar(p.sheen),g.sheenRoughness.value=p.sheenRoughness,p.sheenColorMap&&(g.sheenColorMap.value=p.sheenColorMap,e(p.sheenColorMap,g.sheenColorMapTransform)),p.sheenRoughnessMap&&(g.sheenRoughnessMap.value=p.sheenRoughnessMap,e(p.sheenRoughnessMap,g.sheenRoughnessMapTransform))),p.clearcoat>0&&(g.clearcoat.value=p.clearcoat,g.clearcoatRoughness.value=p.clearcoatRoughness,p.clearcoatMap&&(g.clearcoatMap.value=p.clearcoatMap,e(p.clearcoatMap,g.clearcoatMapTransform)),p.clearcoatRoughnessMap&&(g.clearcoatRoughnessMap.value=p.clearcoatRoughnessMap,e(p.clearcoatRoughnessMap,g.clearcoatRoughnessMapTransform)),p.clearcoatNormalMap&&(g.clearcoatNormalMap.value=p.clearcoatNormalMap,e(p.clearcoatNormalMap,g.clearcoatNormalMapTransform),g.clearcoatNormalScale.value.copy(p.clearcoatNormalScale),p.side===zn&&g.clearcoatNormalScale.value.negate())),p.dispersion>0&&(g.dispersion.value=p.dispersion),p.iridescence>0&&(g.iridescence.value=p.iridescence,g.iridescenceIOR.value=p.iridescenceIOR,g.iridescenceThicknessMinimum.value=p.iridescenceThicknessRange[0],g.iridescenceThicknessMaximum.value=p.iridescenceThicknessRange[1],p.iridescenceMap&&(g.iridescenceMap.value=p.iridescenceMap,e(p.iridescenceMap,g.iridescenceMapTransform)),p.iridescenceThicknessMap&&(g.iridescenceThicknessMap.value=p.iridescenceThicknessMap,e(p.iridescenceThicknessMap,g.iridescenceThicknessMapTransform))),p.transmission>0&&(g.transmission.value=p.transmission,g.transmissionSamplerMap.value=S.texture,g.transmissionSamplerSize.value.set(S.width,S.height),p.transmissionMap&&(g.transmissionMap.value=p.transmissionMap,e(p.transmissionMap,g.transmissionMapTransform)),g.thickness.value=p.thickness,p.thicknessMap&&(g.thicknessMap.value=p.thicknessMap,e(p.thicknessMap,g.thicknessMapTransform)),g.attenuationDistance.value=p.attenuationDistance,g.attenuationColor.value.copy(p.attenuationColor)),p.anisotropy>0&&(g.anisotropyVector.value.set(p.anisotropy*Math.cos(p.anisotropyRotation),p.anisotropy*Math.sin(p.anisotropyRotation)),p.anisotropyMap&&(g.anisotropyMap.value=p.anisotropyMap,e(p.anisotropyMap,g.anisotropyMapTransform))),g.specularIntensity.value=p.specularIntensity,g.specularColor.value.copy(p.specularColor),p.specularColorMap&&(g.specularColorMap.value=p.specularColorMap,e(p.specularColorMap,g.specularColorMapTransform)),p.specularIntensityMap&&(g.specularIntensityMap.value=p.specularIntensityMap,e(p.specularIntensityMap,g.specularIntensityMapTransform))}function m(g,p){p.matcap&&(g.matcap.value=p.matcap)}function _(g,p){let S=t.get(p).light;g.referencePosition.value.setFromMatrixPosition(S.matrixWorld),g.nearDistance.value=S.shadow.camera.near,g.farDistance.value=S.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:s}}function AS(i,t,e,n){let s={},r={},o=[],a=i.getParameter(i.MAX_UNIFORM_BUFFER_BINDINGS);function l(S,v){let y=v.program;n.uniformBlockBinding(S,y)}function c(S,v){let y=s[S.id];y===void 0&&(m(S),y=h(S),s[S.id]=y,S.addEventListener("dispose",g));let U=v.program;n.updateUBOMapping(S,U);let R=t.render.frame;r[S.id]!==R&&(u(S),r[S.id]=R)}function h(S){let v=f();S.__bindingPointIndex=v;let y=i.createBuffer(),U=S.__size,R=S.usage;return i.bindBuffer(i.UNIFORM_BUFFER,y),i.bufferData(i.UNIFORM_BUFFER,U,R),i.bindBuffer(i.UNIFORM_BUFFER,null),i.bindBufferBase(i.UNIFORM_BUFFER,v,y),y}function f(){for(let S=0;S<a;S++)if(o.indexOf(S)===-1)return o.push(S),S;return console.error("THREE.WebGLRenderer: Maximum number of simultaneously usable uniforms groups reached."),0}function u(S){let v=s[S.id],y=S.uniforms,U=S.__cache;i.bindBuffer(i.UNIFORM_BUFFER,v);for(let R=0,P=y.length;R<P;R++){let F=Array.isArray(y[R])?y[R]:[y[R]];for(let E=0,M=F.length;E<M;E++){let A=F[E];if(d(A,R,E,U)===!0){let W=A.__offset,G=Array.isArray(A.value)?A.value:[A.value],X=0;for(let Z=0;Z<G.length;Z++){let Y=G[Z],nt=_(Y);typeof Y=="number"||typeof Y=="boolean"?(A.__data[0]=Y,i.bufferSubData(i.UNIFORM_BUFFER,W+X,A.__data)):Y.isMatrix3?(A.__data[0]=Y.elements[0],A.__data[1]=Y.elements[1],A.__data[2]=Y.elements[2],A.__data[3]=0,A.__data[4]=Y.elements[3],A.__data[5]=Y.elements[4],A.__data[6]=Y.elements[5],A.__data[7]=0,A.__data[8]=Y.elements[6],A.__data[9]=Y.elements[7],A.__data[10]=Y.elements[8],A.__data[11]=0):(Y.toArray(A.__data,X),X+=nt.storage/Float32Array.BYTES_PER_ELEMENT)}i.bufferSubData(i.UNIFORM_BUFFER,W,A.__data)}}}i.bindBuffer(i.UNIFORM_BUFFER,null)}function d(S,v,y,U){let R=S.value,P=v+"_"+y;if(U[P]===void 0)return typeof R=="number"||typeof R=="boolean"?U[P]=R:U[P]=R.clone(),!0;{let F=U[P];if(typeof R=="number"||typeof R=="boolean"){if(F!==R)return U[P]=R,!0}else if(F.equals(R)===!1)return F.copy(R),!0}return!1}function m(S){let v=S.uniforms,y=0,U=16;for(let P=0,F=v.length;P<F;P++){let E=Array.isArray(v[P])?v[P]:[v[P]];for(let M=0,A=E.length;M<A;M++){let W=E[M],G=Array.isArray(W.value)?W.value:[W.value];for(let X=0,Z=G.length;X<Z;X++){let Y=G[X],nt=_(Y),Q=y%U,dt=Q%nt.boundary,at=Q+dt;y+=dt,at!==0&&U-at<nt.storage&&(y+=U-at),W.__data=new Float32Array(nt.storage/Float32Array.BYTES_PER_ELEMENT),W.__offset=y,y+=nt.storage}}}let R=y%U;return R>0&&(y+=U-R),S.__size=y,S.__cache={},this}function _(S){let v={boundary:0,storage:0};return typeof S=="number"||typeof S=="boolean"?(v.boundary=4,v.storage=4):S.isVector2?(v.boundary=8,v.storage=8):S.isVector3||S.isColor?(v.boundary=16,v.storage=12):S.isVector4?(v.boundary=16,v.storage=16):S.isMatrix3?(v.boundary=48,v.storage=48):S.isMatrix4?(v.boundary=64,v.storage=64):S.isTexture?console.warn("THREE.WebGLRenderer: Texture samplers can not be part of an uniforms group."):console.warn("THREE.WebGLRenderer: Unsupported uniform value type.",S),v}function g(S){let v=S.target;v.removeEventListener("dispose",g);let y=o.indexOf(v.__bindingPointIndex);o.splice(y,1),i.deleteBuffer(s[v.id]),delete s[v.id],delete r[v.id]}function p(){for(let S in s)i.deleteBuffer(s[S]);o=[],s={},r={}}return{bind:l,update:c,dispose:p}}var pl=class{constructor(t={}){let{canvas:e=Lx(),context:n=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:f=!1,reverseDepthBuffer:u=!1}=t;this.isWebGLRenderer=!0;let d;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");d=n.getContextAttributes().alpha}else d=o;let m=new Uint32Array(4),_=new Int32Array(4),g=null,p=null,S=[],v=[];this.domElement=e,this.debug={checkShaderErrors:!0,onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this._outputColorSpace=ri,this.toneMapping=Ps,this.toneMappingExposure=1;let y=this,U=!1,R=0,P=0,F=null,E=-1,M=null,A=new De,W=new De,G=null,X=new oe(0),Z=0,Y=e.width,nt=e.height,Q=1,dt=null,at=null,_t=new De(0,0,Y,nt),pt=new De(0,0,Y,nt),Zt=!1,J=new Vo,ht=!1,Ot=!1,lt=new ze,Ft=new ze,Yt=new D,Ut=new De,te={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},st=!1;function mt(){return F===null?Q:1}let N=n;function Vt(T,k){return e.getContext(T,k)}try{let T={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:h,failIfMajorPerformanceCaveat:f};if("setAttribute"in e&&e.setAttribute("data-engine",`three.js r${nf}`),e.addEventListener("webglcontextlost",ot,!1),e.addEventListener("webglcontextrestored",It,!1),e.addEventListener("webglcontextcreationerror",Pt,!1),N===null){let k="webgl2";if(N=Vt(k,T),N===null)throw Vt(k)?new Error("Error creating WebGL context with your selected attributes."):new Error("Error creating WebGL context.")}}catch(T){throw console.error("THREE.WebGLRenderer: "+T.message),T}let ut,Tt,xt,Jt,St,C,b,B,tt,j,et,Nt,Mt,At,Kt,ct,wt,Xt,$t,Rt,ae,ee,we,z;function Et(){ut=new GM(N),ut.init(),ee=new MS(N,ut),Tt=new OM(N,ut,t,ee),xt=new xS(N,ut),Tt.reverseDepthBuffer&&u&&xt.buffers.depth.setReversed(!0),Jt=new qM(N),St=new rS,C=new vS(N,ut,xt,St,Tt,ee,Jt),b=new zM(y),B=new HM(y),tt=new Qx(N),we=new NM(N,tt),j=new WM(N,tt,Jt,we),et=new $M(N,j,tt,Jt),$t=new YM(N,Tt,C),ct=new BM(St),Nt=new sS(y,b,B,ut,Tt,we,ct),Mt=new TS(y,St),At=new aS,Kt=new dS(ut),Xt=new UM(y,b,B,xt,et,d,l),wt=new gS(y,et,Tt),z=new AS(N,Jt,Tt,xt),Rt=new FM(N,ut,Jt),ae=new XM(N,ut,Jt),Jt.programs=Nt.programs,y.capabilities=Tt,y.extensions=ut,y.properties=St,y.renderLists=At,y.shadowMap=wt,y.state=xt,y.info=Jt}Et();let it=new Iu(y,N);this.xr=it,this.getContext=function(){return N},this.getContextAttributes=function(){return N.getContextAttributes()},this.forceContextLoss=function(){let T=ut.get("WEBGL_lose_context");T&&T.loseContext()},this.forceContextRestore=function(){let T=ut.get("WEBGL_lose_context");T&&T.restoreContext()},this.getPixelRatio=function(){return Q},this.setPixelRatio=function(T){T!==void 0&&(Q=T,this.setSize(Y,nt,!1))},this.getSize=function(T){return T.set(Y,nt)},this.setSize=function(T,k,q=!0){if(it.isPresenting){console.warn("THREE.WebGLRenderer: Can't change size while VR device is presenting.");return}Y=T,nt=k,e.width=Math.floor(T*Q),e.height=Math.floor(k*Q),q===!0&&(e.style.width=T+"px",e.style.height=k+"px"),this.setViewport(0,0,T,k)},this.getDrawingBufferSize=function(T){return T.set(Y*Q,nt*Q).floor()},this.setDrawingBufferSize=function(T,k,q){Y=T,nt=k,Q=q,e.width=Math.floor(T*q),e.height=Math.floor(k*q),this.setViewport(0,0,T,k)},this.getCurrentViewport=function(T){return T.copy(A)},this.getViewport=function(T){return T.copy(_t)},this.setViewport=function(T,k,q,K){T.isVector4?_t.set(T.x,T.y,T.z,T.w):_t.set(T,k,q,K),xt.viewport(A.copy(_t).multiplyScalar(Q).round())},this.getScissor=function(T){return T.copy(pt)},this.setScissor=function(T,k,q,K){T.isVector4?pt.set(T.x,T.y,T.z,T.w):pt.set(T,k,q,K),xt.scissor(W.copy(pt).multiplyScalar(Q).round())},this.getScissorTest=function(){return Zt},this.setScissorTest=function(T){xt.setScissorTest(Zt=T)},this.setOpaqueSort=function(T){dt=T},this.setTransparentSort=function(T){at=T},this.getClearColor=function(T){return T.copy(Xt.getClearColor())},this.setClearColor=function(){Xt.setClearColor.apply(Xt,arguments)},this.getClearAlpha=function(){return Xt.getClearAlpha()},this.setClearAlpha=function(){Xt.setClearAlpha.apply(Xt,arguments)},this.clear=function(T=!0,k=!0,q=!0){let K=0;if(T){let H=!1;if(F!==null){let yt=F.texture.format;H=yt===hf||yt===cf||yt===lf}if(H){let yt=F.texture.type,Ct=yt===ls||yt===er||yt===Bo||yt===Kr||yt===of||yt===af,Gt=Xt.getClearColor(),Ht=Xt.getClearAlpha(),jt=Gt.r,ne=Gt.g,Wt=Gt.b;Ct?(m[0]=jt,m[1]=ne,m[2]=Wt,m[3]=Ht,N.clearBufferuiv(N.COLOR,0,m)):(_[0]=jt,_[1]=ne,_[2]=Wt,_[3]=Ht,N.clearBufferiv(N.COLOR,0,_))}else K|=N.COLOR_BUFFER_BIT}k&&(K|=N.DEPTH_BUFFER_BIT),q&&(K|=N.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),N.clear(K)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.dispose=function(){e.removeEventListener("webglcontextlost",ot,!1),e.removeEventListener("webglcontextrestored",It,!1),e.removeEventListener("webglcontextcreationerror",Pt,!1),At.dispose(),Kt.dispose(),St.dispose(),b.dispose(),B.dispose(),et.dispose(),we.dispose(),z.dispose(),Nt.dispose(),it.dispose(),it.removeEventListener("sessionstart",$i),it.removeEventListener("sessionend",Zi),Ke.stop()};function ot(T){T.preventDefault(),console.log("THREE.WebGLRenderer: Context Lost."),U=!0}function It(){console.log("THREE.WebGLRenderer: Context Restored."),U=!1;let T=Jt.autoReset,k=wt.enabled,q=wt.autoUpdate,K=wt.needsUpdate,H=wt.type;Et(),Jt.autoReset=T,wt.enabled=k,wt.autoUpdate=q,wt.needsUpdate=K,wt.type=H}function Pt(T){console.error("THREE.WebGLRenderer: A WebGL context could not be created. Reason: ",T.statusMessage)}function se(T){let k=T.target;k.removeEventListener("dispose",se),We(k)}function We(T){Bt(T),St.remove(T)}function Bt(T){let k=St.get(T).programs;k!==void 0&&(k.forEach(function(q){Nt.releaseProgram(q)}),T.isShaderMaterial&&Nt.releaseShaderCache(T))}this.renderBufferDirect=function(T,k,q,K,H,yt){k===null&&(k=te);let Ct=H.isMesh&&H.matrixWorld.determinant()<0,Gt=Bs(T,k,q,K,H);xt.setMaterial(K,Ct);let Ht=q.index,jt=1;if(K.wireframe===!0){if(Ht=j.getWireframeAttribute(q),Ht===void 0)return;jt=2}let ne=q.drawRange,Wt=q.attributes.position,pe=ne.start*jt,Te=(ne.start+ne.count)*jt;yt!==null&&(pe=Math.max(pe,yt.start*jt),Te=Math.min(Te,(yt.start+yt.count)*jt)),Ht!==null?(pe=Math.max(pe,0),Te=Math.min(Te,Ht.count)):Wt!=null&&(pe=Math.max(pe,0),Te=Math.min(Te,Wt.count));let Ce=Te-pe;if(Ce<0||Ce===1/0)return;we.setup(H,K,Gt,q,Ht);let fn,ye=Rt;if(Ht!==null&&(fn=tt.get(Ht),ye=ae,ye.setIndex(fn)),H.isMesh)K.wireframe===!0?(xt.setLineWidth(K.wireframeLinewidth*mt()),ye.setMode(N.LINES)):ye.setMode(N.TRIANGLES);else if(H.isLine){let zt=K.linewidth;zt===void 0&&(zt=1),xt.setLineWidth(zt*mt()),H.isLineSegments?ye.setMode(N.LINES):H.isLineLoop?ye.setMode(N.LINE_LOOP):ye.setMode(N.LINE_STRIP)}else H.isPoints?ye.setMode(N.POINTS):H.isSprite&&ye.setMode(N.TRIANGLES);if(H.isBatchedMesh)if(H._multiDrawInstances!==null)ye.renderMultiDrawInstances(H._multiDrawStarts,H._multiDrawCounts,H._multiDrawCount,H._multiDrawInstances);else if(ut.get("WEBGL_multi_draw"))ye.renderMultiDraw(H._multiDrawStarts,H._multiDrawCounts,H._multiDrawCount);else{let zt=H._multiDrawStarts,Qn=H._multiDrawCounts,Me=H._multiDrawCount,An=Ht?tt.get(Ht).bytesPerElement:1,Ki=St.get(K).currentProgram.getUniforms();for(let Cn=0;Cn<Me;Cn++)Ki.setValue(N,"_gl_DrawID",Cn),ye.render(zt[Cn]/An,Qn[Cn])}else if(H.isInstancedMesh)ye.renderInstances(pe,Ce,H.count);else if(q.isInstancedBufferGeometry){let zt=q._maxInstanceCount!==void 0?q._maxInstanceCount:1/0,Qn=Math.min(q.instanceCount,zt);ye.renderInstances(pe,Ce,Qn)}else ye.render(pe,Ce)};function fe(T,k,q){T.transparent===!0&&T.side===yi&&T.forceSinglePass===!1?(T.side=zn,T.needsUpdate=!0,gr(T,k,q),T.side=Ls,T.needsUpdate=!0,gr(T,k,q),T.side=yi):gr(T,k,q)}this.compile=function(T,k,q=null){q===null&&(q=T),p=Kt.get(q),p.init(k),v.push(p),q.traverseVisible(function(H){H.isLight&&H.layers.test(k.layers)&&(p.pushLight(H),H.castShadow&&p.pushShadow(H))}),T!==q&&T.traverseVisible(function(H){H.isLight&&H.layers.test(k.layers)&&(p.pushLight(H),H.castShadow&&p.pushShadow(H))}),p.setupLights();let K=new Set;return T.traverse(function(H){if(!(H.isMesh||H.isPoints||H.isLine||H.isSprite))return;let yt=H.material;if(yt)if(Array.isArray(yt))for(let Ct=0;Ct<yt.length;Ct++){let Gt=yt[Ct];fe(Gt,q,H),K.add(Gt)}else fe(yt,q,H),K.add(yt)}),v.pop(),p=null,K},this.compileAsync=function(T,k,q=null){let K=this.compile(T,k,q);return new Promise(H=>{function yt(){if(K.forEach(function(Ct){St.get(Ct).currentProgram.isReady()&&K.delete(Ct)}),K.size===0){H(T);return}setTimeout(yt,10)}ut.get("KHR_parallel_shader_compile")!==null?yt():setTimeout(yt,10)})};let Pe=null;function un(T){Pe&&Pe(T)}function $i(){Ke.stop()}function Zi(){Ke.start()}let Ke=new vm;Ke.setAnimationLoop(un),typeof self<"u"&&Ke.setContext(self),this.setAnimationLoop=function(T){Pe=T,it.setAnimationLoop(T),T===null?Ke.stop():Ke.start()},it.addEventListener("sessionstart",$i),it.addEventListener("sessionend",Zi),this.render=function(T,k){if(k!==void 0&&k.isCamera!==!0){console.error("THREE.WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(U===!0)return;if(T.matrixWorldAutoUpdate===!0&&T.updateMatrixWorld(),k.parent===null&&k.matrixWorldAutoUpdate===!0&&k.updateMatrixWorld(),it.enabled===!0&&it.isPresenting===!0&&(it.cameraAutoUpdate===!0&&it.updateCamera(k),k=it.getCamera()),T.isScene===!0&&T.onBeforeRender(y,T,k,F),p=Kt.get(T,v.length),p.init(k),v.push(p),Ft.multiplyMatrices(k.projectionMatrix,k.matrixWorldInverse),J.setFromProjectionMatrix(Ft),Ot=this.localClippingEnabled,ht=ct.init(this.clippingPlanes,Ot),g=At.get(T,S.length),g.init(),S.push(g),it.enabled===!0&&it.isPresenting===!0){let yt=y.xr.getDepthSensingMesh();yt!==null&&Pi(yt,k,-1/0,y.sortObjects)}Pi(T,k,0,y.sortObjects),g.finish(),y.sortObjects===!0&&g.sort(dt,at),st=it.enabled===!1||it.isPresenting===!1||it.hasDepthSensing()===!1,st&&Xt.addToRenderList(g,T),this.info.render.frame++,ht===!0&&ct.beginShadows();let q=p.state.shadowsArray;wt.render(q,T,k),ht===!0&&ct.endShadows(),this.info.autoReset===!0&&this.info.reset();let K=g.opaque,H=g.transmissive;if(p.setupLights(),k.isArrayCamera){let yt=k.cameras;if(H.length>0)for(let Ct=0,Gt=yt.length;Ct<Gt;Ct++){let Ht=yt[Ct];Mo(K,H,T,Ht)}st&&Xt.render(T);for(let Ct=0,Gt=yt.length;Ct<Gt;Ct++){let Ht=yt[Ct];Ji(g,T,Ht,Ht.viewport)}}else H.length>0&&Mo(K,H,T,k),st&&Xt.render(T),Ji(g,T,k);F!==null&&(C.updateMultisampleRenderTarget(F),C.updateRenderTargetMipmap(F)),T.isScene===!0&&T.onAfterRender(y,T,k),we.resetDefaultState(),E=-1,M=null,v.pop(),v.length>0?(p=v[v.length-1],ht===!0&&ct.setGlobalState(y.clippingPlanes,p.state.camera)):p=null,S.pop(),S.length>0?g=S[S.length-1]:g=null};function Pi(T,k,q,K){if(T.visible===!1)return;if(T.layers.test(k.layers)){if(T.isGroup)q=T.renderOrder;else if(T.isLOD)T.autoUpdate===!0&&T.update(k);else if(T.isLight)p.pushLight(T),T.castShadow&&p.pushShadow(T);else if(T.isSprite){if(!T.frustumCulled||J.intersectsSprite(T)){K&&Ut.setFromMatrixPosition(T.matrixWorld).applyMatrix4(Ft);let Ct=et.update(T),Gt=T.material;Gt.visible&&g.push(T,Ct,Gt,q,Ut.z,null)}}else if((T.isMesh||T.isLine||T.isPoints)&&(!T.frustumCulled||J.intersectsObject(T))){let Ct=et.update(T),Gt=T.material;if(K&&(T.boundingSphere!==void 0?(T.boundingSphere===null&&T.computeBoundingSphere(),Ut.copy(T.boundingSphere.center)):(Ct.boundingSphere===null&&Ct.computeBoundingSphere(),Ut.copy(Ct.boundingSphere.center)),Ut.applyMatrix4(T.matrixWorld).applyMatrix4(Ft)),Array.isArray(Gt)){let Ht=Ct.groups;for(let jt=0,ne=Ht.length;jt<ne;jt++){let Wt=Ht[jt],pe=Gt[Wt.materialIndex];pe&&pe.visible&&g.push(T,Ct,pe,q,Ut.z,Wt)}}else Gt.visible&&g.push(T,Ct,Gt,q,Ut.z,null)}}let yt=T.children;for(let Ct=0,Gt=yt.length;Ct<Gt;Ct++)Pi(yt[Ct],k,q,K)}function Ji(T,k,q,K){let H=T.opaque,yt=T.transmissive,Ct=T.transparent;p.setupLightsView(q),ht===!0&&ct.setGlobalState(y.clippingPlanes,q),K&&xt.viewport(A.copy(K)),H.length>0&&Os(H,k,q),yt.length>0&&Os(yt,k,q),Ct.length>0&&Os(Ct,k,q),xt.buffers.depth.setTest(!0),xt.buffers.depth.setMask(!0),xt.buffers.color.setMask(!0),xt.setPolygonOffset(!1)}function Mo(T,k,q,K){if((q.isScene===!0?q.overrideMaterial:null)!==null)return;p.state.transmissionRenderTarget[K.id]===void 0&&(p.state.transmissionRenderTarget[K.id]=new hs(1,1,{generateMipmaps:!0,type:ut.has("EXT_color_buffer_half_float")||ut.has("EXT_color_buffer_float")?Yo:ls,minFilter:tr,samples:4,stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,colorSpace:be.workingColorSpace}));let yt=p.state.transmissionRenderTarget[K.id],Ct=K.viewport||A;yt.setSize(Ct.z,Ct.w);let Gt=y.getRenderTarget();y.setRenderTarget(yt),y.getClearColor(X),Z=y.getClearAlpha(),Z<1&&y.setClearColor(16777215,.5),y.clear(),st&&Xt.render(q);let Ht=y.toneMapping;y.toneMapping=Ps;let jt=K.viewport;if(K.viewport!==void 0&&(K.viewport=void 0),p.setupLightsView(K),ht===!0&&ct.setGlobalState(y.clippingPlanes,K),Os(T,q,K),C.updateMultisampleRenderTarget(yt),C.updateRenderTargetMipmap(yt),ut.has("WEBGL_multisampled_render_to_texture")===!1){let ne=!1;for(let Wt=0,pe=k.length;Wt<pe;Wt++){let Te=k[Wt],Ce=Te.object,fn=Te.geometry,ye=Te.material,zt=Te.group;if(ye.side===yi&&Ce.layers.test(K.layers)){let Qn=ye.side;ye.side=zn,ye.needsUpdate=!0,ua(Ce,q,K,fn,ye,zt),ye.side=Qn,ye.needsUpdate=!0,ne=!0}}ne===!0&&(C.updateMultisampleRenderTarget(yt),C.updateRenderTargetMipmap(yt))}y.setRenderTarget(Gt),y.setClearColor(X,Z),jt!==void 0&&(K.viewport=jt),y.toneMapping=Ht}function Os(T,k,q){let K=k.isScene===!0?k.overrideMaterial:null;for(let H=0,yt=T.length;H<yt;H++){let Ct=T[H],Gt=Ct.object,Ht=Ct.geometry,jt=K===null?Ct.material:K,ne=Ct.group;Gt.layers.test(q.layers)&&ua(Gt,k,q,Ht,jt,ne)}}function ua(T,k,q,K,H,yt){T.onBeforeRender(y,k,q,K,H,yt),T.modelViewMatrix.multiplyMatrices(q.matrixWorldInverse,T.matrixWorld),T.normalMatrix.getNormalMatrix(T.modelViewMatrix),H.onBeforeRender(y,k,q,K,T,yt),H.transparent===!0&&H.side===yi&&H.forceSinglePass===!1?(H.side=zn,H.needsUpdate=!0,y.renderBufferDirect(q,k,K,H,T,yt),H.side=Ls,H.needsUpdate=!0,y.renderBufferDirect(q,k,K,H,T,yt),H.side=yi):y.renderBufferDirect(q,k,K,H,T,yt),T.onAfterRender(y,k,q,K,H,yt)}function gr(T,k,q){k.isScene!==!0&&(k=te);let K=St.get(T),H=p.state.lights,yt=p.state.shadowsArray,Ct=H.state.version,Gt=Nt.getParameters(T,H.state,yt,k,q),Ht=Nt.getProgramCacheKey(Gt),jt=K.programs;K.environment=T.isMeshStandardMaterial?k.environment:null,K.fog=k.fog,K.envMap=(T.isMeshStandardMaterial?B:b).get(T.envMap||K.environment),K.envMapRotation=K.environment!==null&&T.envMap===null?k.environmentRotation:T.envMapRotation,jt===void 0&&(T.addEventListener("dispose",se),jt=new Map,K.programs=jt);let ne=jt.get(Ht);if(ne!==void 0){if(K.currentProgram===ne&&K.lightsStateVersion===Ct)return fa(T,Gt),ne}else Gt.uniforms=Nt.getUniforms(T),T.onBeforeCompile(Gt,y),ne=Nt.acquireProgram(Gt,Ht),jt.set(Ht,ne),K.uniforms=Gt.uniforms;let Wt=K.uniforms;return(!T.isShaderMaterial&&!T.isRawShaderMaterial||T.clipping===!0)&&(Wt.clippingPlanes=ct.uniform),fa(T,Gt),K.needsLights=Li(T),K.lightsStateVersion=Ct,K.needsLights&&(Wt.ambientLightColor.value=H.state.ambient,Wt.lightProbe.value=H.state.probe,Wt.directionalLights.value=H.state.directional,Wt.directionalLightShadows.value=H.state.directionalShadow,Wt.spotLights.value=H.state.spot,Wt.spotLightShadows.value=H.state.spotShadow,Wt.rectAreaLights.value=H.state.rectArea,Wt.ltc_1.value=H.state.rectAreaLTC1,Wt.ltc_2.value=H.state.rectAreaLTC2,Wt.pointLights.value=H.state.point,Wt.pointLightShadows.value=H.state.pointShadow,Wt.hemisphereLights.value=H.state.hemi,Wt.directionalShadowMap.value=H.state.directionalShadowMap,Wt.directionalShadowMatrix.value=H.state.directionalShadowMatrix,Wt.spotShadowMap.value=H.state.spotShadowMap,Wt.spotLightMatrix.value=H.state.spotLightMatrix,Wt.spotLightMap.value=H.state.spotLightMap,Wt.pointShadowMap.value=H.state.pointShadowMap,Wt.pointShadowMatrix.value=H.state.pointShadowMatrix),K.currentProgram=ne,K.uniformsList=null,ne}function Ii(T){if(T.uniformsList===null){let k=T.currentProgram.getUniforms();T.uniformsList=Yr.seqWithValue(k.seq,T.uniforms)}return T.uniformsList}function fa(T,k){let q=St.get(T);q.outputColorSpace=k.outputColorSpace,q.batching=k.batching,q.batchingColor=k.batchingColor,q.instancing=k.instancing,q.instancingColor=k.instancingColor,q.instancingMorph=k.instancingMorph,q.skinning=k.skinning,q.morphTargets=k.morphTargets,q.morphNormals=k.morphNormals,q.morphColors=k.morphColors,q.morphTargetsCount=k.morphTargetsCount,q.numClippingPlanes=k.numClippingPlanes,q.numIntersection=k.numClipIntersection,q.vertexAlphas=k.vertexAlphas,q.vertexTangents=k.vertexTangents,q.toneMapping=k.toneMapping}function Bs(T,k,q,K,H){k.isScene!==!0&&(k=te),C.resetTextureUnits();let yt=k.fog,Ct=K.isMeshStandardMaterial?k.environment:null,Gt=F===null?y.outputColorSpace:F.isXRRenderTarget===!0?F.texture.colorSpace:ro,Ht=(K.isMeshStandardMaterial?B:b).get(K.envMap||Ct),jt=K.vertexColors===!0&&!!q.attributes.color&&q.attributes.color.itemSize===4,ne=!!q.attributes.tangent&&(!!K.normalMap||K.anisotropy>0),Wt=!!q.morphAttributes.position,pe=!!q.morphAttributes.normal,Te=!!q.morphAttributes.color,Ce=Ps;K.toneMapped&&(F===null||F.isXRRenderTarget===!0)&&(Ce=y.toneMapping);let fn=q.morphAttributes.position||q.morphAttributes.normal||q.morphAttributes.color,ye=fn!==void 0?fn.length:0,zt=St.get(K),Qn=p.state.lights;if(ht===!0&&(Ot===!0||T!==M)){let Fn=T===M&&K.id===E;ct.setState(K,T,Fn)}let Me=!1;K.version===zt.__version?(zt.needsLights&&zt.lightsStateVersion!==Qn.state.version||zt.outputColorSpace!==Gt||H.isBatchedMesh&&zt.batching===!1||!H.isBatchedMesh&&zt.batching===!0||H.isBatchedMesh&&zt.batchingColor===!0&&H.colorTexture===null||H.isBatchedMesh&&zt.batchingColor===!1&&H.colorTexture!==null||H.isInstancedMesh&&zt.instancing===!1||!H.isInstancedMesh&&zt.instancing===!0||H.isSkinnedMesh&&zt.skinning===!1||!H.isSkinnedMesh&&zt.skinning===!0||H.isInstancedMesh&&zt.instancingColor===!0&&H.instanceColor===null||H.isInstancedMesh&&zt.instancingColor===!1&&H.instanceColor!==null||H.isInstancedMesh&&zt.instancingMorph===!0&&H.morphTexture===null||H.isInstancedMesh&&zt.instancingMorph===!1&&H.morphTexture!==null||zt.envMap!==Ht||K.fog===!0&&zt.fog!==yt||zt.numClippingPlanes!==void 0&&(zt.numClippingPlanes!==ct.numPlanes||zt.numIntersection!==ct.numIntersection)||zt.vertexAlphas!==jt||zt.vertexTangents!==ne||zt.morphTargets!==Wt||zt.morphNormals!==pe||zt.morphColors!==Te||zt.toneMapping!==Ce||zt.morphTargetsCount!==ye)&&(Me=!0):(Me=!0,zt.__version=K.version);let An=zt.currentProgram;Me===!0&&(An=gr(K,k,H));let Ki=!1,Cn=!1,zs=!1,Ne=An.getUniforms(),Gn=zt.uniforms;if(xt.useProgram(An.program)&&(Ki=!0,Cn=!0,zs=!0),K.id!==E&&(E=K.id,Cn=!0),Ki||M!==T){xt.buffers.depth.getReversed()?(lt.copy(T.projectionMatrix),Ux(lt),Nx(lt),Ne.setValue(N,"projectionMatrix",lt)):Ne.setValue(N,"projectionMatrix",T.projectionMatrix),Ne.setValue(N,"viewMatrix",T.matrixWorldInverse);let di=Ne.map.cameraPosition;di!==void 0&&di.setValue(N,Yt.setFromMatrixPosition(T.matrixWorld)),Tt.logarithmicDepthBuffer&&Ne.setValue(N,"logDepthBufFC",2/(Math.log(T.far+1)/Math.LN2)),(K.isMeshPhongMaterial||K.isMeshToonMaterial||K.isMeshLambertMaterial||K.isMeshBasicMaterial||K.isMeshStandardMaterial||K.isShaderMaterial)&&Ne.setValue(N,"isOrthographic",T.isOrthographicCamera===!0),M!==T&&(M=T,Cn=!0,zs=!0)}if(H.isSkinnedMesh){Ne.setOptional(N,H,"bindMatrix"),Ne.setOptional(N,H,"bindMatrixInverse");let Fn=H.skeleton;Fn&&(Fn.boneTexture===null&&Fn.computeBoneTexture(),Ne.setValue(N,"boneTexture",Fn.boneTexture,C))}H.isBatchedMesh&&(Ne.setOptional(N,H,"batchingTexture"),Ne.setValue(N,"batchingTexture",H._matricesTexture,C),Ne.setOptional(N,H,"batchingIdTexture"),Ne.setValue(N,"batchingIdTexture",H._indirectTexture,C),Ne.setOptional(N,H,"batchingColorTexture"),H._colorsTexture!==null&&Ne.setValue(N,"batchingColorTexture",H._colorsTexture,C));let gs=q.morphAttributes;if((gs.position!==void 0||gs.normal!==void 0||gs.color!==void 0)&&$t.update(H,q,An),(Cn||zt.receiveShadow!==H.receiveShadow)&&(zt.receiveShadow=H.receiveShadow,Ne.setValue(N,"receiveShadow",H.receiveShadow)),K.isMeshGouraudMaterial&&K.envMap!==null&&(Gn.envMap.value=Ht,Gn.flipEnvMap.value=Ht.isCubeTexture&&Ht.isRenderTargetTexture===!1?-1:1),K.isMeshStandardMaterial&&K.envMap===null&&k.environment!==null&&(Gn.envMapIntensity.value=k.environmentIntensity),Cn&&(Ne.setValue(N,"toneMappingExposure",y.toneMappingExposure),zt.needsLights&&da(Gn,zs),yt&&K.fog===!0&&Mt.refreshFogUniforms(Gn,yt),Mt.refreshMaterialUniforms(Gn,K,Q,nt,p.state.transmissionRenderTarget[T.id]),Yr.upload(N,Ii(zt),Gn,C)),K.isShaderMaterial&&K.uniformsNeedUpdate===!0&&(Yr.upload(N,Ii(zt),Gn,C),K.uniformsNeedUpdate=!1),K.isSpriteMaterial&&Ne.setValue(N,"center",H.center),Ne.setValue(N,"modelViewMatrix",H.modelViewMatrix),Ne.setValue(N,"normalMatrix",H.normalMatrix),Ne.setValue(N,"modelMatrix",H.matrixWorld),K.isShaderMaterial||K.isRawShaderMaterial){let Fn=K.uniformsGroups;for(let di=0,ti=Fn.length;di<ti;di++){let ks=Fn[di];z.update(ks,An),z.bind(ks,An)}}return An}function da(T,k){T.ambientLightColor.needsUpdate=k,T.lightProbe.needsUpdate=k,T.directionalLights.needsUpdate=k,T.directionalLightShadows.needsUpdate=k,T.pointLights.needsUpdate=k,T.pointLightShadows.needsUpdate=k,T.spotLights.needsUpdate=k,T.spotLightShadows.needsUpdate=k,T.rectAreaLights.needsUpdate=k,T.hemisphereLights.needsUpdate=k}function Li(T){return T.isMeshLambertMaterial||T.isMeshToonMaterial||T.isMeshPhongMaterial||T.isMeshStandardMaterial||T.isShadowMaterial||T.isShaderMaterial&&T.lights===!0}this.getActiveCubeFace=function(){return R},this.getActiveMipmapLevel=function(){return P},this.getRenderTarget=function(){return F},this.setRenderTargetTextures=function(T,k,q){St.get(T.texture).__webglTexture=k,St.get(T.depthTexture).__webglTexture=q;let K=St.get(T);K.__hasExternalTextures=!0,K.__autoAllocateDepthBuffer=q===void 0,K.__autoAllocateDepthBuffer||ut.has("WEBGL_multisampled_render_to_texture")===!0&&(console.warn("THREE.WebGLRenderer: Render-to-texture extension was disabled because an external texture was provided"),K.__useRenderToTexture=!1)},this.setRenderTargetFramebuffer=function(T,k){let q=St.get(T);q.__webglFramebuffer=k,q.__useDefaultFramebuffer=k===void 0},this.setRenderTarget=function(T,k=0,q=0){F=T,R=k,P=q;let K=!0,H=null,yt=!1,Ct=!1;if(T){let Ht=St.get(T);if(Ht.__useDefaultFramebuffer!==void 0)xt.bindFramebuffer(N.FRAMEBUFFER,null),K=!1;else if(Ht.__webglFramebuffer===void 0)C.setupRenderTarget(T);else if(Ht.__hasExternalTextures)C.rebindTextures(T,St.get(T.texture).__webglTexture,St.get(T.depthTexture).__webglTexture);else if(T.depthBuffer){let Wt=T.depthTexture;if(Ht.__boundDepthTexture!==Wt){if(Wt!==null&&St.has(Wt)&&(T.width!==Wt.image.width||T.height!==Wt.image.height))throw new Error("WebGLRenderTarget: Attached DepthTexture is initialized to the incorrect size.");C.setupDepthRenderbuffer(T)}}let jt=T.texture;(jt.isData3DTexture||jt.isDataArrayTexture||jt.isCompressedArrayTexture)&&(Ct=!0);let ne=St.get(T).__webglFramebuffer;T.isWebGLCubeRenderTarget?(Array.isArray(ne[k])?H=ne[k][q]:H=ne[k],yt=!0):T.samples>0&&C.useMultisampledRTT(T)===!1?H=St.get(T).__webglMultisampledFramebuffer:Array.isArray(ne)?H=ne[q]:H=ne,A.copy(T.viewport),W.copy(T.scissor),G=T.scissorTest}else A.copy(_t).multiplyScalar(Q).floor(),W.copy(pt).multiplyScalar(Q).floor(),G=Zt;if(xt.bindFramebuffer(N.FRAMEBUFFER,H)&&K&&xt.drawBuffers(T,H),xt.viewport(A),xt.scissor(W),xt.setScissorTest(G),yt){let Ht=St.get(T.texture);N.framebufferTexture2D(N.FRAMEBUFFER,N.COLOR_ATTACHMENT0,N.TEXTURE_CUBE_MAP_POSITIVE_X+k,Ht.__webglTexture,q)}else if(Ct){let Ht=St.get(T.texture),jt=k||0;N.framebufferTextureLayer(N.FRAMEBUFFER,N.COLOR_ATTACHMENT0,Ht.__webglTexture,q||0,jt)}E=-1},this.readRenderTargetPixels=function(T,k,q,K,H,yt,Ct){if(!(T&&T.isWebGLRenderTarget)){console.error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let Gt=St.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&Ct!==void 0&&(Gt=Gt[Ct]),Gt){xt.bindFramebuffer(N.FRAMEBUFFER,Gt);try{let Ht=T.texture,jt=Ht.format,ne=Ht.type;if(!Tt.textureFormatReadable(jt)){console.error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(!Tt.textureTypeReadable(ne)){console.error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}k>=0&&k<=T.width-K&&q>=0&&q<=T.height-H&&N.readPixels(k,q,K,H,ee.convert(jt),ee.convert(ne),yt)}finally{let Ht=F!==null?St.get(F).__webglFramebuffer:null;xt.bindFramebuffer(N.FRAMEBUFFER,Ht)}}},this.readRenderTargetPixelsAsync=async function(T,k,q,K,H,yt,Ct){if(!(T&&T.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let Gt=St.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&Ct!==void 0&&(Gt=Gt[Ct]),Gt){let Ht=T.texture,jt=Ht.format,ne=Ht.type;if(!Tt.textureFormatReadable(jt))throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(!Tt.textureTypeReadable(ne))throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");if(k>=0&&k<=T.width-K&&q>=0&&q<=T.height-H){xt.bindFramebuffer(N.FRAMEBUFFER,Gt);let Wt=N.createBuffer();N.bindBuffer(N.PIXEL_PACK_BUFFER,Wt),N.bufferData(N.PIXEL_PACK_BUFFER,yt.byteLength,N.STREAM_READ),N.readPixels(k,q,K,H,ee.convert(jt),ee.convert(ne),0);let pe=F!==null?St.get(F).__webglFramebuffer:null;xt.bindFramebuffer(N.FRAMEBUFFER,pe);let Te=N.fenceSync(N.SYNC_GPU_COMMANDS_COMPLETE,0);return N.flush(),await Dx(N,Te,4),N.bindBuffer(N.PIXEL_PACK_BUFFER,Wt),N.getBufferSubData(N.PIXEL_PACK_BUFFER,0,yt),N.deleteBuffer(Wt),N.deleteSync(Te),yt}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")}},this.copyFramebufferToTexture=function(T,k=null,q=0){T.isTexture!==!0&&(Lo("WebGLRenderer: copyFramebufferToTexture function signature has changed."),k=arguments[0]||null,T=arguments[1]);let K=Math.pow(2,-q),H=Math.floor(T.image.width*K),yt=Math.floor(T.image.height*K),Ct=k!==null?k.x:0,Gt=k!==null?k.y:0;C.setTexture2D(T,0),N.copyTexSubImage2D(N.TEXTURE_2D,q,0,0,Ct,Gt,H,yt),xt.unbindTexture()},this.copyTextureToTexture=function(T,k,q=null,K=null,H=0){T.isTexture!==!0&&(Lo("WebGLRenderer: copyTextureToTexture function signature has changed."),K=arguments[0]||null,T=arguments[1],k=arguments[2],H=arguments[3]||0,q=null);let yt,Ct,Gt,Ht,jt,ne,Wt,pe,Te,Ce=T.isCompressedTexture?T.mipmaps[H]:T.image;q!==null?(yt=q.max.x-q.min.x,Ct=q.max.y-q.min.y,Gt=q.isBox3?q.max.z-q.min.z:1,Ht=q.min.x,jt=q.min.y,ne=q.isBox3?q.min.z:0):(yt=Ce.width,Ct=Ce.height,Gt=Ce.depth||1,Ht=0,jt=0,ne=0),K!==null?(Wt=K.x,pe=K.y,Te=K.z):(Wt=0,pe=0,Te=0);let fn=ee.convert(k.format),ye=ee.convert(k.type),zt;k.isData3DTexture?(C.setTexture3D(k,0),zt=N.TEXTURE_3D):k.isDataArrayTexture||k.isCompressedArrayTexture?(C.setTexture2DArray(k,0),zt=N.TEXTURE_2D_ARRAY):(C.setTexture2D(k,0),zt=N.TEXTURE_2D),N.pixelStorei(N.UNPACK_FLIP_Y_WEBGL,k.flipY),N.pixelStorei(N.UNPACK_PREMULTIPLY_ALPHA_WEBGL,k.premultiplyAlpha),N.pixelStorei(N.UNPACK_ALIGNMENT,k.unpackAlignment);let Qn=N.getParameter(N.UNPACK_ROW_LENGTH),Me=N.getParameter(N.UNPACK_IMAGE_HEIGHT),An=N.getParameter(N.UNPACK_SKIP_PIXELS),Ki=N.getParameter(N.UNPACK_SKIP_ROWS),Cn=N.getParameter(N.UNPACK_SKIP_IMAGES);N.pixelStorei(N.UNPACK_ROW_LENGTH,Ce.width),N.pixelStorei(N.UNPACK_IMAGE_HEIGHT,Ce.height),N.pixelStorei(N.UNPACK_SKIP_PIXELS,Ht),N.pixelStorei(N.UNPACK_SKIP_ROWS,jt),N.pixelStorei(N.UNPACK_SKIP_IMAGES,ne);let zs=T.isDataArrayTexture||T.isData3DTexture,Ne=k.isDataArrayTexture||k.isData3DTexture;if(T.isRenderTargetTexture||T.isDepthTexture){let Gn=St.get(T),gs=St.get(k),Fn=St.get(Gn.__renderTarget),di=St.get(gs.__renderTarget);xt.bindFramebuffer(N.READ_FRAMEBUFFER,Fn.__webglFramebuffer),xt.bindFramebuffer(N.DRAW_FRAMEBUFFER,di.__webglFramebuffer);for(let ti=0;ti<Gt;ti++)zs&&N.framebufferTextureLayer(N.READ_FRAMEBUFFER,N.COLOR_ATTACHMENT0,St.get(T).__webglTexture,H,ne+ti),T.isDepthTexture?(Ne&&N.framebufferTextureLayer(N.DRAW_FRAMEBUFFER,N.COLOR_ATTACHMENT0,St.get(k).__webglTexture,H,Te+ti),N.blitFramebuffer(Ht,jt,yt,Ct,Wt,pe,yt,Ct,N.DEPTH_BUFFER_BIT,N.NEAREST)):Ne?N.copyTexSubImage3D(zt,H,Wt,pe,Te+ti,Ht,jt,yt,Ct):N.copyTexSubImage2D(zt,H,Wt,pe,Te+ti,Ht,jt,yt,Ct);xt.bindFramebuffer(N.READ_FRAMEBUFFER,null),xt.bindFramebuffer(N.DRAW_FRAMEBUFFER,null)}else Ne?T.isDataTexture||T.isData3DTexture?N.texSubImage3D(zt,H,Wt,pe,Te,yt,Ct,Gt,fn,ye,Ce.data):k.isCompressedArrayTexture?N.compressedTexSubImage3D(zt,H,Wt,pe,Te,yt,Ct,Gt,fn,Ce.data):N.texSubImage3D(zt,H,Wt,pe,Te,yt,Ct,Gt,fn,ye,Ce):T.isDataTexture?N.texSubImage2D(N.TEXTURE_2D,H,Wt,pe,yt,Ct,fn,ye,Ce.data):T.isCompressedTexture?N.compressedTexSubImage2D(N.TEXTURE_2D,H,Wt,pe,Ce.width,Ce.height,fn,Ce.data):N.texSubImage2D(N.TEXTURE_2D,H,Wt,pe,yt,Ct,fn,ye,Ce);N.pixelStorei(N.UNPACK_ROW_LENGTH,Qn),N.pixelStorei(N.UNPACK_IMAGE_HEIGHT,Me),N.pixelStorei(N.UNPACK_SKIP_PIXELS,An),N.pixelStorei(N.UNPACK_SKIP_ROWS,Ki),N.pixelStorei(N.UNPACK_SKIP_IMAGES,Cn),H===0&&k.generateMipmaps&&N.generateMipmap(zt),xt.unbindTexture()},this.copyTextureToTexture3D=function(T,k,q=null,K=null,H=0){return T.isTexture!==!0&&(Lo("WebGLRenderer: copyTextureToTexture3D function signature has changed."),q=arguments[0]||null,K=arguments[1]||null,T=arguments[2],k=arguments[3],H=arguments[4]||0),Lo('WebGLRenderer: copyTextureToTexture3D function has been deprecated. Use "copyTextureToTexture" instead.'),this.copyTextureToTexture(T,k,q,K,H)},this.initRenderTarget=function(T){St.get(T).__webglFramebuffer===void 0&&C.setupRenderTarget(T)},this.initTexture=function(T){T.isCubeTexture?C.setTextureCube(T,0):T.isData3DTexture?C.setTexture3D(T,0):T.isDataArrayTexture||T.isCompressedArrayTexture?C.setTexture2DArray(T,0):C.setTexture2D(T,0),xt.unbindTexture()},this.resetState=function(){R=0,P=0,F=null,xt.reset(),we.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return os}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(t){this._outputColorSpace=t;let e=this.getContext();e.drawingBufferColorspace=be._getDrawingBufferColorSpace(t),e.unpackColorSpace=be._getUnpackColorSpace()}};var ml=class extends En{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new ki,this.environmentIntensity=1,this.environmentRotation=new ki,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(t,e){return super.copy(t,e),t.background!==null&&(this.background=t.background.clone()),t.environment!==null&&(this.environment=t.environment.clone()),t.fog!==null&&(this.fog=t.fog.clone()),this.backgroundBlurriness=t.backgroundBlurriness,this.backgroundIntensity=t.backgroundIntensity,this.backgroundRotation.copy(t.backgroundRotation),this.environmentIntensity=t.environmentIntensity,this.environmentRotation.copy(t.environmentRotation),t.overrideMaterial!==null&&(this.overrideMaterial=t.overrideMaterial.clone()),this.matrixAutoUpdate=t.matrixAutoUpdate,this}toJSON(t){let e=super.toJSON(t);return this.fog!==null&&(e.object.fog=this.fog.toJSON()),this.backgroundBlurriness>0&&(e.object.backgroundBlurriness=this.backgroundBlurriness),this.backgroundIntensity!==1&&(e.object.backgroundIntensity=this.backgroundIntensity),e.object.backgroundRotation=this.backgroundRotation.toArray(),this.environmentIntensity!==1&&(e.object.environmentIntensity=this.environmentIntensity),e.object.environmentRotation=this.environmentRotation.toArray(),e}},Lu=class{constructor(t,e){this.isInterleavedBuffer=!0,this.array=t,this.stride=e,this.count=t!==void 0?t.length/e:0,this.usage=mu,this.updateRanges=[],this.version=0,this.uuid=Bi()}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.array=new t.array.constructor(t.array),this.count=t.count,this.stride=t.stride,this.usage=t.usage,this}copyAt(t,e,n){t*=this.stride,n*=e.stride;for(let s=0,r=this.stride;s<r;s++)this.array[t+s]=e.array[n+s];return this}set(t,e=0){return this.array.set(t,e),this}clone(t){t.arrayBuffers===void 0&&(t.arrayBuffers={}),this.array.buffer._uuid===void 0&&(this.array.buffer._uuid=Bi()),t.arrayBuffers[this.array.buffer._uuid]===void 0&&(t.arrayBuffers[this.array.buffer._uuid]=this.array.slice(0).buffer);let e=new this.array.constructor(t.arrayBuffers[this.array.buffer._uuid]),n=new this.constructor(e,this.stride);return n.setUsage(this.usage),n}onUpload(t){return this.onUploadCallback=t,this}toJSON(t){return t.arrayBuffers===void 0&&(t.arrayBuffers={}),this.array.buffer._uuid===void 0&&(this.array.buffer._uuid=Bi()),t.arrayBuffers[this.array.buffer._uuid]===void 0&&(t.arrayBuffers[this.array.buffer._uuid]=Array.from(new Uint32Array(this.array.buffer))),{uuid:this.uuid,buffer:this.array.buffer._uuid,type:this.array.constructor.name,stride:this.stride}}},Ln=new D,Hi=class i{constructor(t,e,n,s=!1){this.isInterleavedBufferAttribute=!0,this.name="",this.data=t,this.itemSize=e,this.offset=n,this.normalized=s}get count(){return this.data.count}get array(){return this.data.array}set needsUpdate(t){this.data.needsUpdate=t}applyMatrix4(t){for(let e=0,n=this.data.count;e<n;e++)Ln.fromBufferAttribute(this,e),Ln.applyMatrix4(t),this.setXYZ(e,Ln.x,Ln.y,Ln.z);return this}applyNormalMatrix(t){for(let e=0,n=this.count;e<n;e++)Ln.fromBufferAttribute(this,e),Ln.applyNormalMatrix(t),this.setXYZ(e,Ln.x,Ln.y,Ln.z);return this}transformDirection(t){for(let e=0,n=this.count;e<n;e++)Ln.fromBufferAttribute(this,e),Ln.transformDirection(t),this.setXYZ(e,Ln.x,Ln.y,Ln.z);return this}getComponent(t,e){let n=this.array[t*this.data.stride+this.offset+e];return this.normalized&&(n=vi(n,this.array)),n}setComponent(t,e,n){return this.normalized&&(n=Re(n,this.array)),this.data.array[t*this.data.stride+this.offset+e]=n,this}setX(t,e){return this.normalized&&(e=Re(e,this.array)),this.data.array[t*this.data.stride+this.offset]=e,this}setY(t,e){return this.normalized&&(e=Re(e,this.array)),this.data.array[t*this.data.stride+this.offset+1]=e,this}setZ(t,e){return this.normalized&&(e=Re(e,this.array)),this.data.array[t*this.data.stride+this.offset+2]=e,this}setW(t,e){return this.normalized&&(e=Re(e,this.array)),this.data.array[t*this.data.stride+this.offset+3]=e,this}getX(t){let e=this.data.array[t*this.data.stride+this.offset];return this.normalized&&(e=vi(e,this.array)),e}getY(t){let e=this.data.array[t*this.data.stride+this.offset+1];return this.normalized&&(e=vi(e,this.array)),e}getZ(t){let e=this.data.array[t*this.data.stride+this.offset+2];return this.normalized&&(e=vi(e,this.array)),e}getW(t){let e=this.data.array[t*this.data.stride+this.offset+3];return this.normalized&&(e=vi(e,this.array)),e}setXY(t,e,n){return t=t*this.data.stride+this.offset,this.normalized&&(e=Re(e,this.array),n=Re(n,this.array)),this.data.array[t+0]=e,this.data.array[t+1]=n,this}setXYZ(t,e,n,s){return t=t*this.data.stride+this.offset,this.normalized&&(e=Re(e,this.array),n=Re(n,this.array),s=Re(s,this.array)),this.data.array[t+0]=e,this.data.array[t+1]=n,this.data.array[t+2]=s,this}setXYZW(t,e,n,s,r){return t=t*this.data.stride+this.offset,this.normalized&&(e=Re(e,this.array),n=Re(n,this.array),s=Re(s,this.array),r=Re(r,this.array)),this.data.array[t+0]=e,this.data.array[t+1]=n,this.data.array[t+2]=s,this.data.array[t+3]=r,this}clone(t){if(t===void 0){console.log("THREE.InterleavedBufferAttribute.clone(): Cloning an interleaved buffer attribute will de-interleave buffer data.");let e=[];for(let n=0;n<this.count;n++){let s=n*this.data.stride+this.offset;for(let r=0;r<this.itemSize;r++)e.push(this.data.array[s+r])}return new $n(new this.array.constructor(e),this.itemSize,this.normalized)}else return t.interleavedBuffers===void 0&&(t.interleavedBuffers={}),t.interleavedBuffers[this.data.uuid]===void 0&&(t.interleavedBuffers[this.data.uuid]=this.data.clone(t)),new i(t.interleavedBuffers[this.data.uuid],this.itemSize,this.offset,this.normalized)}toJSON(t){if(t===void 0){console.log("THREE.InterleavedBufferAttribute.toJSON(): Serializing an interleaved buffer attribute will de-interleave buffer data.");let e=[];for(let n=0;n<this.count;n++){let s=n*this.data.stride+this.offset;for(let r=0;r<this.itemSize;r++)e.push(this.data.array[s+r])}return{itemSize:this.itemSize,type:this.array.constructor.name,array:e,normalized:this.normalized}}else return t.interleavedBuffers===void 0&&(t.interleavedBuffers={}),t.interleavedBuffers[this.data.uuid]===void 0&&(t.interleavedBuffers[this.data.uuid]=this.data.toJSON(t)),{isInterleavedBufferAttribute:!0,itemSize:this.itemSize,data:this.data.uuid,offset:this.offset,normalized:this.normalized}}};var Ho=class extends Ds{static get type(){return"LineBasicMaterial"}constructor(t){super(),this.isLineBasicMaterial=!0,this.color=new oe(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.linewidth=t.linewidth,this.linecap=t.linecap,this.linejoin=t.linejoin,this.fog=t.fog,this}},gl=new D,_l=new D,Vp=new ze,Io=new nr,Ha=new zi,Sh=new D,Hp=new D,xl=class extends En{constructor(t=new ve,e=new Ho){super(),this.isLine=!0,this.type="Line",this.geometry=t,this.material=e,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[0];for(let s=1,r=e.count;s<r;s++)gl.fromBufferAttribute(e,s-1),_l.fromBufferAttribute(e,s),n[s]=n[s-1],n[s]+=gl.distanceTo(_l);t.setAttribute("lineDistance",new Qt(n,1))}else console.warn("THREE.Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Line.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),Ha.copy(n.boundingSphere),Ha.applyMatrix4(s),Ha.radius+=r,t.ray.intersectsSphere(Ha)===!1)return;Vp.copy(s).invert(),Io.copy(t.ray).applyMatrix4(Vp);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=this.isLineSegments?2:1,h=n.index,u=n.attributes.position;if(h!==null){let d=Math.max(0,o.start),m=Math.min(h.count,o.start+o.count);for(let _=d,g=m-1;_<g;_+=c){let p=h.getX(_),S=h.getX(_+1),v=Ga(this,t,Io,l,p,S);v&&e.push(v)}if(this.isLineLoop){let _=h.getX(m-1),g=h.getX(d),p=Ga(this,t,Io,l,_,g);p&&e.push(p)}}else{let d=Math.max(0,o.start),m=Math.min(u.count,o.start+o.count);for(let _=d,g=m-1;_<g;_+=c){let p=Ga(this,t,Io,l,_,_+1);p&&e.push(p)}if(this.isLineLoop){let _=Ga(this,t,Io,l,m-1,d);_&&e.push(_)}}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function Ga(i,t,e,n,s,r){let o=i.geometry.attributes.position;if(gl.fromBufferAttribute(o,s),_l.fromBufferAttribute(o,r),e.distanceSqToSegment(gl,_l,Sh,Hp)>n)return;Sh.applyMatrix4(i.matrixWorld);let l=t.ray.origin.distanceTo(Sh);if(!(l<t.near||l>t.far))return{distance:l,point:Hp.clone().applyMatrix4(i.matrixWorld),index:s,face:null,faceIndex:null,barycoord:null,object:i}}var Gp=new D,Wp=new D,on=class extends xl{constructor(t,e){super(t,e),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[];for(let s=0,r=e.count;s<r;s+=2)Gp.fromBufferAttribute(e,s),Wp.fromBufferAttribute(e,s+1),n[s]=s===0?0:n[s-1],n[s+1]=n[s]+Gp.distanceTo(Wp);t.setAttribute("lineDistance",new Qt(n,1))}else console.warn("THREE.LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}},yl=class extends xl{constructor(t,e){super(t,e),this.isLineLoop=!0,this.type="LineLoop"}};var li=class{constructor(){this.type="Curve",this.arcLengthDivisions=200}getPoint(){return console.warn("THREE.Curve: .getPoint() not implemented."),null}getPointAt(t,e){let n=this.getUtoTmapping(t);return this.getPoint(n,e)}getPoints(t=5){let e=[];for(let n=0;n<=t;n++)e.push(this.getPoint(n/t));return e}getSpacedPoints(t=5){let e=[];for(let n=0;n<=t;n++)e.push(this.getPointAt(n/t));return e}getLength(){let t=this.getLengths();return t[t.length-1]}getLengths(t=this.arcLengthDivisions){if(this.cacheArcLengths&&this.cacheArcLengths.length===t+1&&!this.needsUpdate)return this.cacheArcLengths;this.needsUpdate=!1;let e=[],n,s=this.getPoint(0),r=0;e.push(0);for(let o=1;o<=t;o++)n=this.getPoint(o/t),r+=n.distanceTo(s),e.push(r),s=n;return this.cacheArcLengths=e,e}updateArcLengths(){this.needsUpdate=!0,this.getLengths()}getUtoTmapping(t,e){let n=this.getLengths(),s=0,r=n.length,o;e?o=e:o=t*n[r-1];let a=0,l=r-1,c;for(;a<=l;)if(s=Math.floor(a+(l-a)/2),c=n[s]-o,c<0)a=s+1;else if(c>0)l=s-1;else{l=s;break}if(s=l,n[s]===o)return s/(r-1);let h=n[s],u=n[s+1]-h,d=(o-h)/u;return(s+d)/(r-1)}getTangent(t,e){let s=t-1e-4,r=t+1e-4;s<0&&(s=0),r>1&&(r=1);let o=this.getPoint(s),a=this.getPoint(r),l=e||(o.isVector2?new gt:new D);return l.copy(a).sub(o).normalize(),l}getTangentAt(t,e){let n=this.getUtoTmapping(t);return this.getTangent(n,e)}computeFrenetFrames(t,e){let n=new D,s=[],r=[],o=[],a=new D,l=new ze;for(let d=0;d<=t;d++){let m=d/t;s[d]=this.getTangentAt(m,new D)}r[0]=new D,o[0]=new D;let c=Number.MAX_VALUE,h=Math.abs(s[0].x),f=Math.abs(s[0].y),u=Math.abs(s[0].z);h<=c&&(c=h,n.set(1,0,0)),f<=c&&(c=f,n.set(0,1,0)),u<=c&&n.set(0,0,1),a.crossVectors(s[0],n).normalize(),r[0].crossVectors(s[0],a),o[0].crossVectors(s[0],r[0]);for(let d=1;d<=t;d++){if(r[d]=r[d-1].clone(),o[d]=o[d-1].clone(),a.crossVectors(s[d-1],s[d]),a.length()>Number.EPSILON){a.normalize();let m=Math.acos(nn(s[d-1].dot(s[d]),-1,1));r[d].applyMatrix4(l.makeRotationAxis(a,m))}o[d].crossVectors(s[d],r[d])}if(e===!0){let d=Math.acos(nn(r[0].dot(r[t]),-1,1));d/=t,s[0].dot(a.crossVectors(r[0],r[t]))>0&&(d=-d);for(let m=1;m<=t;m++)r[m].applyMatrix4(l.makeRotationAxis(s[m],d*m)),o[m].crossVectors(s[m],r[m])}return{tangents:s,normals:r,binormals:o}}clone(){return new this.constructor().copy(this)}copy(t){return this.arcLengthDivisions=t.arcLengthDivisions,this}toJSON(){let t={metadata:{version:4.6,type:"Curve",generator:"Curve.toJSON"}};return t.arcLengthDivisions=this.arcLengthDivisions,t.type=this.type,t}fromJSON(t){return this.arcLengthDivisions=t.arcLengthDivisions,this}},Go=class extends li{constructor(t=0,e=0,n=1,s=1,r=0,o=Math.PI*2,a=!1,l=0){super(),this.isEllipseCurve=!0,this.type="EllipseCurve",this.aX=t,this.aY=e,this.xRadius=n,this.yRadius=s,this.aStartAngle=r,this.aEndAngle=o,this.aClockwise=a,this.aRotation=l}getPoint(t,e=new gt){let n=e,s=Math.PI*2,r=this.aEndAngle-this.aStartAngle,o=Math.abs(r)<Number.EPSILON;for(;r<0;)r+=s;for(;r>s;)r-=s;r<Number.EPSILON&&(o?r=0:r=s),this.aClockwise===!0&&!o&&(r===s?r=-s:r=r-s);let a=this.aStartAngle+t*r,l=this.aX+this.xRadius*Math.cos(a),c=this.aY+this.yRadius*Math.sin(a);if(this.aRotation!==0){let h=Math.cos(this.aRotation),f=Math.sin(this.aRotation),u=l-this.aX,d=c-this.aY;l=u*h-d*f+this.aX,c=u*f+d*h+this.aY}return n.set(l,c)}copy(t){return super.copy(t),this.aX=t.aX,this.aY=t.aY,this.xRadius=t.xRadius,this.yRadius=t.yRadius,this.aStartAngle=t.aStartAngle,this.aEndAngle=t.aEndAngle,this.aClockwise=t.aClockwise,this.aRotation=t.aRotation,this}toJSON(){let t=super.toJSON();return t.aX=this.aX,t.aY=this.aY,t.xRadius=this.xRadius,t.yRadius=this.yRadius,t.aStartAngle=this.aStartAngle,t.aEndAngle=this.aEndAngle,t.aClockwise=this.aClockwise,t.aRotation=this.aRotation,t}fromJSON(t){return super.fromJSON(t),this.aX=t.aX,this.aY=t.aY,this.xRadius=t.xRadius,this.yRadius=t.yRadius,this.aStartAngle=t.aStartAngle,this.aEndAngle=t.aEndAngle,this.aClockwise=t.aClockwise,this.aRotation=t.aRotation,this}},Du=class extends Go{constructor(t,e,n,s,r,o){super(t,e,n,n,s,r,o),this.isArcCurve=!0,this.type="ArcCurve"}};function df(){let i=0,t=0,e=0,n=0;function s(r,o,a,l){i=r,t=a,e=-3*r+3*o-2*a-l,n=2*r-2*o+a+l}return{initCatmullRom:function(r,o,a,l,c){s(o,a,c*(a-r),c*(l-o))},initNonuniformCatmullRom:function(r,o,a,l,c,h,f){let u=(o-r)/c-(a-r)/(c+h)+(a-o)/h,d=(a-o)/h-(l-o)/(h+f)+(l-a)/f;u*=h,d*=h,s(o,a,u,d)},calc:function(r){let o=r*r,a=o*r;return i+t*r+e*o+n*a}}}var Wa=new D,wh=new df,Eh=new df,Th=new df,Uu=class extends li{constructor(t=[],e=!1,n="centripetal",s=.5){super(),this.isCatmullRomCurve3=!0,this.type="CatmullRomCurve3",this.points=t,this.closed=e,this.curveType=n,this.tension=s}getPoint(t,e=new D){let n=e,s=this.points,r=s.length,o=(r-(this.closed?0:1))*t,a=Math.floor(o),l=o-a;this.closed?a+=a>0?0:(Math.floor(Math.abs(a)/r)+1)*r:l===0&&a===r-1&&(a=r-2,l=1);let c,h;this.closed||a>0?c=s[(a-1)%r]:(Wa.subVectors(s[0],s[1]).add(s[0]),c=Wa);let f=s[a%r],u=s[(a+1)%r];if(this.closed||a+2<r?h=s[(a+2)%r]:(Wa.subVectors(s[r-1],s[r-2]).add(s[r-1]),h=Wa),this.curveType==="centripetal"||this.curveType==="chordal"){let d=this.curveType==="chordal"?.5:.25,m=Math.pow(c.distanceToSquared(f),d),_=Math.pow(f.distanceToSquared(u),d),g=Math.pow(u.distanceToSquared(h),d);_<1e-4&&(_=1),m<1e-4&&(m=_),g<1e-4&&(g=_),wh.initNonuniformCatmullRom(c.x,f.x,u.x,h.x,m,_,g),Eh.initNonuniformCatmullRom(c.y,f.y,u.y,h.y,m,_,g),Th.initNonuniformCatmullRom(c.z,f.z,u.z,h.z,m,_,g)}else this.curveType==="catmullrom"&&(wh.initCatmullRom(c.x,f.x,u.x,h.x,this.tension),Eh.initCatmullRom(c.y,f.y,u.y,h.y,this.tension),Th.initCatmullRom(c.z,f.z,u.z,h.z,this.tension));return n.set(wh.calc(l),Eh.calc(l),Th.calc(l)),n}copy(t){super.copy(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(s.clone())}return this.closed=t.closed,this.curveType=t.curveType,this.tension=t.tension,this}toJSON(){let t=super.toJSON();t.points=[];for(let e=0,n=this.points.length;e<n;e++){let s=this.points[e];t.points.push(s.toArray())}return t.closed=this.closed,t.curveType=this.curveType,t.tension=this.tension,t}fromJSON(t){super.fromJSON(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(new D().fromArray(s))}return this.closed=t.closed,this.curveType=t.curveType,this.tension=t.tension,this}};function Xp(i,t,e,n,s){let r=(n-t)*.5,o=(s-e)*.5,a=i*i,l=i*a;return(2*e-2*n+r+o)*l+(-3*e+3*n-2*r-o)*a+r*i+e}function CS(i,t){let e=1-i;return e*e*t}function RS(i,t){return 2*(1-i)*i*t}function PS(i,t){return i*i*t}function Fo(i,t,e,n){return CS(i,t)+RS(i,e)+PS(i,n)}function IS(i,t){let e=1-i;return e*e*e*t}function LS(i,t){let e=1-i;return 3*e*e*i*t}function DS(i,t){return 3*(1-i)*i*i*t}function US(i,t){return i*i*i*t}function Oo(i,t,e,n,s){return IS(i,t)+LS(i,e)+DS(i,n)+US(i,s)}var vl=class extends li{constructor(t=new gt,e=new gt,n=new gt,s=new gt){super(),this.isCubicBezierCurve=!0,this.type="CubicBezierCurve",this.v0=t,this.v1=e,this.v2=n,this.v3=s}getPoint(t,e=new gt){let n=e,s=this.v0,r=this.v1,o=this.v2,a=this.v3;return n.set(Oo(t,s.x,r.x,o.x,a.x),Oo(t,s.y,r.y,o.y,a.y)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this.v3.copy(t.v3),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t.v3=this.v3.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this.v3.fromArray(t.v3),this}},Nu=class extends li{constructor(t=new D,e=new D,n=new D,s=new D){super(),this.isCubicBezierCurve3=!0,this.type="CubicBezierCurve3",this.v0=t,this.v1=e,this.v2=n,this.v3=s}getPoint(t,e=new D){let n=e,s=this.v0,r=this.v1,o=this.v2,a=this.v3;return n.set(Oo(t,s.x,r.x,o.x,a.x),Oo(t,s.y,r.y,o.y,a.y),Oo(t,s.z,r.z,o.z,a.z)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this.v3.copy(t.v3),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t.v3=this.v3.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this.v3.fromArray(t.v3),this}},Ml=class extends li{constructor(t=new gt,e=new gt){super(),this.isLineCurve=!0,this.type="LineCurve",this.v1=t,this.v2=e}getPoint(t,e=new gt){let n=e;return t===1?n.copy(this.v2):(n.copy(this.v2).sub(this.v1),n.multiplyScalar(t).add(this.v1)),n}getPointAt(t,e){return this.getPoint(t,e)}getTangent(t,e=new gt){return e.subVectors(this.v2,this.v1).normalize()}getTangentAt(t,e){return this.getTangent(t,e)}copy(t){return super.copy(t),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},Fu=class extends li{constructor(t=new D,e=new D){super(),this.isLineCurve3=!0,this.type="LineCurve3",this.v1=t,this.v2=e}getPoint(t,e=new D){let n=e;return t===1?n.copy(this.v2):(n.copy(this.v2).sub(this.v1),n.multiplyScalar(t).add(this.v1)),n}getPointAt(t,e){return this.getPoint(t,e)}getTangent(t,e=new D){return e.subVectors(this.v2,this.v1).normalize()}getTangentAt(t,e){return this.getTangent(t,e)}copy(t){return super.copy(t),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},bl=class extends li{constructor(t=new gt,e=new gt,n=new gt){super(),this.isQuadraticBezierCurve=!0,this.type="QuadraticBezierCurve",this.v0=t,this.v1=e,this.v2=n}getPoint(t,e=new gt){let n=e,s=this.v0,r=this.v1,o=this.v2;return n.set(Fo(t,s.x,r.x,o.x),Fo(t,s.y,r.y,o.y)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},Ou=class extends li{constructor(t=new D,e=new D,n=new D){super(),this.isQuadraticBezierCurve3=!0,this.type="QuadraticBezierCurve3",this.v0=t,this.v1=e,this.v2=n}getPoint(t,e=new D){let n=e,s=this.v0,r=this.v1,o=this.v2;return n.set(Fo(t,s.x,r.x,o.x),Fo(t,s.y,r.y,o.y),Fo(t,s.z,r.z,o.z)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},Sl=class extends li{constructor(t=[]){super(),this.isSplineCurve=!0,this.type="SplineCurve",this.points=t}getPoint(t,e=new gt){let n=e,s=this.points,r=(s.length-1)*t,o=Math.floor(r),a=r-o,l=s[o===0?o:o-1],c=s[o],h=s[o>s.length-2?s.length-1:o+1],f=s[o>s.length-3?s.length-1:o+2];return n.set(Xp(a,l.x,c.x,h.x,f.x),Xp(a,l.y,c.y,h.y,f.y)),n}copy(t){super.copy(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(s.clone())}return this}toJSON(){let t=super.toJSON();t.points=[];for(let e=0,n=this.points.length;e<n;e++){let s=this.points[e];t.points.push(s.toArray())}return t}fromJSON(t){super.fromJSON(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(new gt().fromArray(s))}return this}},Bu=Object.freeze({__proto__:null,ArcCurve:Du,CatmullRomCurve3:Uu,CubicBezierCurve:vl,CubicBezierCurve3:Nu,EllipseCurve:Go,LineCurve:Ml,LineCurve3:Fu,QuadraticBezierCurve:bl,QuadraticBezierCurve3:Ou,SplineCurve:Sl}),zu=class extends li{constructor(){super(),this.type="CurvePath",this.curves=[],this.autoClose=!1}add(t){this.curves.push(t)}closePath(){let t=this.curves[0].getPoint(0),e=this.curves[this.curves.length-1].getPoint(1);if(!t.equals(e)){let n=t.isVector2===!0?"LineCurve":"LineCurve3";this.curves.push(new Bu[n](e,t))}return this}getPoint(t,e){let n=t*this.getLength(),s=this.getCurveLengths(),r=0;for(;r<s.length;){if(s[r]>=n){let o=s[r]-n,a=this.curves[r],l=a.getLength(),c=l===0?0:1-o/l;return a.getPointAt(c,e)}r++}return null}getLength(){let t=this.getCurveLengths();return t[t.length-1]}updateArcLengths(){this.needsUpdate=!0,this.cacheLengths=null,this.getCurveLengths()}getCurveLengths(){if(this.cacheLengths&&this.cacheLengths.length===this.curves.length)return this.cacheLengths;let t=[],e=0;for(let n=0,s=this.curves.length;n<s;n++)e+=this.curves[n].getLength(),t.push(e);return this.cacheLengths=t,t}getSpacedPoints(t=40){let e=[];for(let n=0;n<=t;n++)e.push(this.getPoint(n/t));return this.autoClose&&e.push(e[0]),e}getPoints(t=12){let e=[],n;for(let s=0,r=this.curves;s<r.length;s++){let o=r[s],a=o.isEllipseCurve?t*2:o.isLineCurve||o.isLineCurve3?1:o.isSplineCurve?t*o.points.length:t,l=o.getPoints(a);for(let c=0;c<l.length;c++){let h=l[c];n&&n.equals(h)||(e.push(h),n=h)}}return this.autoClose&&e.length>1&&!e[e.length-1].equals(e[0])&&e.push(e[0]),e}copy(t){super.copy(t),this.curves=[];for(let e=0,n=t.curves.length;e<n;e++){let s=t.curves[e];this.curves.push(s.clone())}return this.autoClose=t.autoClose,this}toJSON(){let t=super.toJSON();t.autoClose=this.autoClose,t.curves=[];for(let e=0,n=this.curves.length;e<n;e++){let s=this.curves[e];t.curves.push(s.toJSON())}return t}fromJSON(t){super.fromJSON(t),this.autoClose=t.autoClose,this.curves=[];for(let e=0,n=t.curves.length;e<n;e++){let s=t.curves[e];this.curves.push(new Bu[s.type]().fromJSON(s))}return this}},wl=class extends zu{constructor(t){super(),this.type="Path",this.currentPoint=new gt,t&&this.setFromPoints(t)}setFromPoints(t){this.moveTo(t[0].x,t[0].y);for(let e=1,n=t.length;e<n;e++)this.lineTo(t[e].x,t[e].y);return this}moveTo(t,e){return this.currentPoint.set(t,e),this}lineTo(t,e){let n=new Ml(this.currentPoint.clone(),new gt(t,e));return this.curves.push(n),this.currentPoint.set(t,e),this}quadraticCurveTo(t,e,n,s){let r=new bl(this.currentPoint.clone(),new gt(t,e),new gt(n,s));return this.curves.push(r),this.currentPoint.set(n,s),this}bezierCurveTo(t,e,n,s,r,o){let a=new vl(this.currentPoint.clone(),new gt(t,e),new gt(n,s),new gt(r,o));return this.curves.push(a),this.currentPoint.set(r,o),this}splineThru(t){let e=[this.currentPoint.clone()].concat(t),n=new Sl(e);return this.curves.push(n),this.currentPoint.copy(t[t.length-1]),this}arc(t,e,n,s,r,o){let a=this.currentPoint.x,l=this.currentPoint.y;return this.absarc(t+a,e+l,n,s,r,o),this}absarc(t,e,n,s,r,o){return this.absellipse(t,e,n,n,s,r,o),this}ellipse(t,e,n,s,r,o,a,l){let c=this.currentPoint.x,h=this.currentPoint.y;return this.absellipse(t+c,e+h,n,s,r,o,a,l),this}absellipse(t,e,n,s,r,o,a,l){let c=new Go(t,e,n,s,r,o,a,l);if(this.curves.length>0){let f=c.getPoint(0);f.equals(this.currentPoint)||this.lineTo(f.x,f.y)}this.curves.push(c);let h=c.getPoint(1);return this.currentPoint.copy(h),this}copy(t){return super.copy(t),this.currentPoint.copy(t.currentPoint),this}toJSON(){let t=super.toJSON();return t.currentPoint=this.currentPoint.toArray(),t}fromJSON(t){return super.fromJSON(t),this.currentPoint.fromArray(t.currentPoint),this}};var El=class i extends ve{constructor(t=1,e=32,n=0,s=Math.PI*2){super(),this.type="CircleGeometry",this.parameters={radius:t,segments:e,thetaStart:n,thetaLength:s},e=Math.max(3,e);let r=[],o=[],a=[],l=[],c=new D,h=new gt;o.push(0,0,0),a.push(0,0,1),l.push(.5,.5);for(let f=0,u=3;f<=e;f++,u+=3){let d=n+f/e*s;c.x=t*Math.cos(d),c.y=t*Math.sin(d),o.push(c.x,c.y,c.z),a.push(0,0,1),h.x=(o[u]/t+1)/2,h.y=(o[u+1]/t+1)/2,l.push(h.x,h.y)}for(let f=1;f<=e;f++)r.push(f,f+1,0);this.setIndex(r),this.setAttribute("position",new Qt(o,3)),this.setAttribute("normal",new Qt(a,3)),this.setAttribute("uv",new Qt(l,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.radius,t.segments,t.thetaStart,t.thetaLength)}},fs=class i extends ve{constructor(t=1,e=1,n=1,s=32,r=1,o=!1,a=0,l=Math.PI*2){super(),this.type="CylinderGeometry",this.parameters={radiusTop:t,radiusBottom:e,height:n,radialSegments:s,heightSegments:r,openEnded:o,thetaStart:a,thetaLength:l};let c=this;s=Math.floor(s),r=Math.floor(r);let h=[],f=[],u=[],d=[],m=0,_=[],g=n/2,p=0;S(),o===!1&&(t>0&&v(!0),e>0&&v(!1)),this.setIndex(h),this.setAttribute("position",new Qt(f,3)),this.setAttribute("normal",new Qt(u,3)),this.setAttribute("uv",new Qt(d,2));function S(){let y=new D,U=new D,R=0,P=(e-t)/n;for(let F=0;F<=r;F++){let E=[],M=F/r,A=M*(e-t)+t;for(let W=0;W<=s;W++){let G=W/s,X=G*l+a,Z=Math.sin(X),Y=Math.cos(X);U.x=A*Z,U.y=-M*n+g,U.z=A*Y,f.push(U.x,U.y,U.z),y.set(Z,P,Y).normalize(),u.push(y.x,y.y,y.z),d.push(G,1-M),E.push(m++)}_.push(E)}for(let F=0;F<s;F++)for(let E=0;E<r;E++){let M=_[E][F],A=_[E+1][F],W=_[E+1][F+1],G=_[E][F+1];(t>0||E!==0)&&(h.push(M,A,G),R+=3),(e>0||E!==r-1)&&(h.push(A,W,G),R+=3)}c.addGroup(p,R,0),p+=R}function v(y){let U=m,R=new gt,P=new D,F=0,E=y===!0?t:e,M=y===!0?1:-1;for(let W=1;W<=s;W++)f.push(0,g*M,0),u.push(0,M,0),d.push(.5,.5),m++;let A=m;for(let W=0;W<=s;W++){let X=W/s*l+a,Z=Math.cos(X),Y=Math.sin(X);P.x=E*Y,P.y=g*M,P.z=E*Z,f.push(P.x,P.y,P.z),u.push(0,M,0),R.x=Z*.5+.5,R.y=Y*.5*M+.5,d.push(R.x,R.y),m++}for(let W=0;W<s;W++){let G=U+W,X=A+W;y===!0?h.push(X,X+1,G):h.push(X+1,X,G),F+=3}c.addGroup(p,F,y===!0?1:2),p+=F}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.radiusTop,t.radiusBottom,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},Tl=class i extends fs{constructor(t=1,e=1,n=32,s=1,r=!1,o=0,a=Math.PI*2){super(0,t,e,n,s,r,o,a),this.type="ConeGeometry",this.parameters={radius:t,height:e,radialSegments:n,heightSegments:s,openEnded:r,thetaStart:o,thetaLength:a}}static fromJSON(t){return new i(t.radius,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},ku=class i extends ve{constructor(t=[],e=[],n=1,s=0){super(),this.type="PolyhedronGeometry",this.parameters={vertices:t,indices:e,radius:n,detail:s};let r=[],o=[];a(s),c(n),h(),this.setAttribute("position",new Qt(r,3)),this.setAttribute("normal",new Qt(r.slice(),3)),this.setAttribute("uv",new Qt(o,2)),s===0?this.computeVertexNormals():this.normalizeNormals();function a(S){let v=new D,y=new D,U=new D;for(let R=0;R<e.length;R+=3)d(e[R+0],v),d(e[R+1],y),d(e[R+2],U),l(v,y,U,S)}function l(S,v,y,U){let R=U+1,P=[];for(let F=0;F<=R;F++){P[F]=[];let E=S.clone().lerp(y,F/R),M=v.clone().lerp(y,F/R),A=R-F;for(let W=0;W<=A;W++)W===0&&F===R?P[F][W]=E:P[F][W]=E.clone().lerp(M,W/A)}for(let F=0;F<R;F++)for(let E=0;E<2*(R-F)-1;E++){let M=Math.floor(E/2);E%2===0?(u(P[F][M+1]),u(P[F+1][M]),u(P[F][M])):(u(P[F][M+1]),u(P[F+1][M+1]),u(P[F+1][M]))}}function c(S){let v=new D;for(let y=0;y<r.length;y+=3)v.x=r[y+0],v.y=r[y+1],v.z=r[y+2],v.normalize().multiplyScalar(S),r[y+0]=v.x,r[y+1]=v.y,r[y+2]=v.z}function h(){let S=new D;for(let v=0;v<r.length;v+=3){S.x=r[v+0],S.y=r[v+1],S.z=r[v+2];let y=g(S)/2/Math.PI+.5,U=p(S)/Math.PI+.5;o.push(y,1-U)}m(),f()}function f(){for(let S=0;S<o.length;S+=6){let v=o[S+0],y=o[S+2],U=o[S+4],R=Math.max(v,y,U),P=Math.min(v,y,U);R>.9&&P<.1&&(v<.2&&(o[S+0]+=1),y<.2&&(o[S+2]+=1),U<.2&&(o[S+4]+=1))}}function u(S){r.push(S.x,S.y,S.z)}function d(S,v){let y=S*3;v.x=t[y+0],v.y=t[y+1],v.z=t[y+2]}function m(){let S=new D,v=new D,y=new D,U=new D,R=new gt,P=new gt,F=new gt;for(let E=0,M=0;E<r.length;E+=9,M+=6){S.set(r[E+0],r[E+1],r[E+2]),v.set(r[E+3],r[E+4],r[E+5]),y.set(r[E+6],r[E+7],r[E+8]),R.set(o[M+0],o[M+1]),P.set(o[M+2],o[M+3]),F.set(o[M+4],o[M+5]),U.copy(S).add(v).add(y).divideScalar(3);let A=g(U);_(R,M+0,S,A),_(P,M+2,v,A),_(F,M+4,y,A)}}function _(S,v,y,U){U<0&&S.x===1&&(o[v]=S.x-1),y.x===0&&y.z===0&&(o[v]=U/2/Math.PI+.5)}function g(S){return Math.atan2(S.z,-S.x)}function p(S){return Math.atan2(-S.y,Math.sqrt(S.x*S.x+S.z*S.z))}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.vertices,t.indices,t.radius,t.details)}};var Xa=new D,qa=new D,Ah=new D,Ya=new Fi,ci=class extends ve{constructor(t=null,e=1){if(super(),this.type="EdgesGeometry",this.parameters={geometry:t,thresholdAngle:e},t!==null){let s=Math.pow(10,4),r=Math.cos(Xr*e),o=t.getIndex(),a=t.getAttribute("position"),l=o?o.count:a.count,c=[0,0,0],h=["a","b","c"],f=new Array(3),u={},d=[];for(let m=0;m<l;m+=3){o?(c[0]=o.getX(m),c[1]=o.getX(m+1),c[2]=o.getX(m+2)):(c[0]=m,c[1]=m+1,c[2]=m+2);let{a:_,b:g,c:p}=Ya;if(_.fromBufferAttribute(a,c[0]),g.fromBufferAttribute(a,c[1]),p.fromBufferAttribute(a,c[2]),Ya.getNormal(Ah),f[0]=`${Math.round(_.x*s)},${Math.round(_.y*s)},${Math.round(_.z*s)}`,f[1]=`${Math.round(g.x*s)},${Math.round(g.y*s)},${Math.round(g.z*s)}`,f[2]=`${Math.round(p.x*s)},${Math.round(p.y*s)},${Math.round(p.z*s)}`,!(f[0]===f[1]||f[1]===f[2]||f[2]===f[0]))for(let S=0;S<3;S++){let v=(S+1)%3,y=f[S],U=f[v],R=Ya[h[S]],P=Ya[h[v]],F=`${y}_${U}`,E=`${U}_${y}`;E in u&&u[E]?(Ah.dot(u[E].normal)<=r&&(d.push(R.x,R.y,R.z),d.push(P.x,P.y,P.z)),u[E]=null):F in u||(u[F]={index0:c[S],index1:c[v],normal:Ah.clone()})}}for(let m in u)if(u[m]){let{index0:_,index1:g}=u[m];Xa.fromBufferAttribute(a,_),qa.fromBufferAttribute(a,g),d.push(Xa.x,Xa.y,Xa.z),d.push(qa.x,qa.y,qa.z)}this.setAttribute("position",new Qt(d,3))}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}},Us=class extends wl{constructor(t){super(t),this.uuid=Bi(),this.type="Shape",this.holes=[]}getPointsHoles(t){let e=[];for(let n=0,s=this.holes.length;n<s;n++)e[n]=this.holes[n].getPoints(t);return e}extractPoints(t){return{shape:this.getPoints(t),holes:this.getPointsHoles(t)}}copy(t){super.copy(t),this.holes=[];for(let e=0,n=t.holes.length;e<n;e++){let s=t.holes[e];this.holes.push(s.clone())}return this}toJSON(){let t=super.toJSON();t.uuid=this.uuid,t.holes=[];for(let e=0,n=this.holes.length;e<n;e++){let s=this.holes[e];t.holes.push(s.toJSON())}return t}fromJSON(t){super.fromJSON(t),this.uuid=t.uuid,this.holes=[];for(let e=0,n=t.holes.length;e<n;e++){let s=t.holes[e];this.holes.push(new wl().fromJSON(s))}return this}},NS={triangulate:function(i,t,e=2){let n=t&&t.length,s=n?t[0]*e:i.length,r=Em(i,0,s,e,!0),o=[];if(!r||r.next===r.prev)return o;let a,l,c,h,f,u,d;if(n&&(r=kS(i,t,r,e)),i.length>80*e){a=c=i[0],l=h=i[1];for(let m=e;m<s;m+=e)f=i[m],u=i[m+1],f<a&&(a=f),u<l&&(l=u),f>c&&(c=f),u>h&&(h=u);d=Math.max(c-a,h-l),d=d!==0?32767/d:0}return Wo(r,o,e,a,l,d,0),o}};function Em(i,t,e,n,s){let r,o;if(s===KS(i,t,e,n)>0)for(r=t;r<e;r+=n)o=qp(r,i[r],i[r+1],o);else for(r=e-n;r>=t;r-=n)o=qp(r,i[r],i[r+1],o);return o&&Wl(o,o.next)&&(qo(o),o=o.next),o}function ir(i,t){if(!i)return i;t||(t=i);let e=i,n;do if(n=!1,!e.steiner&&(Wl(e,e.next)||Ye(e.prev,e,e.next)===0)){if(qo(e),e=t=e.prev,e===e.next)break;n=!0}else e=e.next;while(n||e!==t);return t}function Wo(i,t,e,n,s,r,o){if(!i)return;!o&&r&&XS(i,n,s,r);let a=i,l,c;for(;i.prev!==i.next;){if(l=i.prev,c=i.next,r?OS(i,n,s,r):FS(i)){t.push(l.i/e|0),t.push(i.i/e|0),t.push(c.i/e|0),qo(i),i=c.next,a=c.next;continue}if(i=c,i===a){o?o===1?(i=BS(ir(i),t,e),Wo(i,t,e,n,s,r,2)):o===2&&zS(i,t,e,n,s,r):Wo(ir(i),t,e,n,s,r,1);break}}}function FS(i){let t=i.prev,e=i,n=i.next;if(Ye(t,e,n)>=0)return!1;let s=t.x,r=e.x,o=n.x,a=t.y,l=e.y,c=n.y,h=s<r?s<o?s:o:r<o?r:o,f=a<l?a<c?a:c:l<c?l:c,u=s>r?s>o?s:o:r>o?r:o,d=a>l?a>c?a:c:l>c?l:c,m=n.next;for(;m!==t;){if(m.x>=h&&m.x<=u&&m.y>=f&&m.y<=d&&Hr(s,a,r,l,o,c,m.x,m.y)&&Ye(m.prev,m,m.next)>=0)return!1;m=m.next}return!0}function OS(i,t,e,n){let s=i.prev,r=i,o=i.next;if(Ye(s,r,o)>=0)return!1;let a=s.x,l=r.x,c=o.x,h=s.y,f=r.y,u=o.y,d=a<l?a<c?a:c:l<c?l:c,m=h<f?h<u?h:u:f<u?f:u,_=a>l?a>c?a:c:l>c?l:c,g=h>f?h>u?h:u:f>u?f:u,p=Vu(d,m,t,e,n),S=Vu(_,g,t,e,n),v=i.prevZ,y=i.nextZ;for(;v&&v.z>=p&&y&&y.z<=S;){if(v.x>=d&&v.x<=_&&v.y>=m&&v.y<=g&&v!==s&&v!==o&&Hr(a,h,l,f,c,u,v.x,v.y)&&Ye(v.prev,v,v.next)>=0||(v=v.prevZ,y.x>=d&&y.x<=_&&y.y>=m&&y.y<=g&&y!==s&&y!==o&&Hr(a,h,l,f,c,u,y.x,y.y)&&Ye(y.prev,y,y.next)>=0))return!1;y=y.nextZ}for(;v&&v.z>=p;){if(v.x>=d&&v.x<=_&&v.y>=m&&v.y<=g&&v!==s&&v!==o&&Hr(a,h,l,f,c,u,v.x,v.y)&&Ye(v.prev,v,v.next)>=0)return!1;v=v.prevZ}for(;y&&y.z<=S;){if(y.x>=d&&y.x<=_&&y.y>=m&&y.y<=g&&y!==s&&y!==o&&Hr(a,h,l,f,c,u,y.x,y.y)&&Ye(y.prev,y,y.next)>=0)return!1;y=y.nextZ}return!0}function BS(i,t,e){let n=i;do{let s=n.prev,r=n.next.next;!Wl(s,r)&&Tm(s,n,n.next,r)&&Xo(s,r)&&Xo(r,s)&&(t.push(s.i/e|0),t.push(n.i/e|0),t.push(r.i/e|0),qo(n),qo(n.next),n=i=r),n=n.next}while(n!==i);return ir(n)}function zS(i,t,e,n,s,r){let o=i;do{let a=o.next.next;for(;a!==o.prev;){if(o.i!==a.i&&$S(o,a)){let l=Am(o,a);o=ir(o,o.next),l=ir(l,l.next),Wo(o,t,e,n,s,r,0),Wo(l,t,e,n,s,r,0);return}a=a.next}o=o.next}while(o!==i)}function kS(i,t,e,n){let s=[],r,o,a,l,c;for(r=0,o=t.length;r<o;r++)a=t[r]*n,l=r<o-1?t[r+1]*n:i.length,c=Em(i,a,l,n,!1),c===c.next&&(c.steiner=!0),s.push(YS(c));for(s.sort(VS),r=0;r<s.length;r++)e=HS(s[r],e);return e}function VS(i,t){return i.x-t.x}function HS(i,t){let e=GS(i,t);if(!e)return t;let n=Am(e,i);return ir(n,n.next),ir(e,e.next)}function GS(i,t){let e=t,n=-1/0,s,r=i.x,o=i.y;do{if(o<=e.y&&o>=e.next.y&&e.next.y!==e.y){let u=e.x+(o-e.y)*(e.next.x-e.x)/(e.next.y-e.y);if(u<=r&&u>n&&(n=u,s=e.x<e.next.x?e:e.next,u===r))return s}e=e.next}while(e!==t);if(!s)return null;let a=s,l=s.x,c=s.y,h=1/0,f;e=s;do r>=e.x&&e.x>=l&&r!==e.x&&Hr(o<c?r:n,o,l,c,o<c?n:r,o,e.x,e.y)&&(f=Math.abs(o-e.y)/(r-e.x),Xo(e,i)&&(f<h||f===h&&(e.x>s.x||e.x===s.x&&WS(s,e)))&&(s=e,h=f)),e=e.next;while(e!==a);return s}function WS(i,t){return Ye(i.prev,i,t.prev)<0&&Ye(t.next,i,i.next)<0}function XS(i,t,e,n){let s=i;do s.z===0&&(s.z=Vu(s.x,s.y,t,e,n)),s.prevZ=s.prev,s.nextZ=s.next,s=s.next;while(s!==i);s.prevZ.nextZ=null,s.prevZ=null,qS(s)}function qS(i){let t,e,n,s,r,o,a,l,c=1;do{for(e=i,i=null,r=null,o=0;e;){for(o++,n=e,a=0,t=0;t<c&&(a++,n=n.nextZ,!!n);t++);for(l=c;a>0||l>0&&n;)a!==0&&(l===0||!n||e.z<=n.z)?(s=e,e=e.nextZ,a--):(s=n,n=n.nextZ,l--),r?r.nextZ=s:i=s,s.prevZ=r,r=s;e=n}r.nextZ=null,c*=2}while(o>1);return i}function Vu(i,t,e,n,s){return i=(i-e)*s|0,t=(t-n)*s|0,i=(i|i<<8)&16711935,i=(i|i<<4)&252645135,i=(i|i<<2)&858993459,i=(i|i<<1)&1431655765,t=(t|t<<8)&16711935,t=(t|t<<4)&252645135,t=(t|t<<2)&858993459,t=(t|t<<1)&1431655765,i|t<<1}function YS(i){let t=i,e=i;do(t.x<e.x||t.x===e.x&&t.y<e.y)&&(e=t),t=t.next;while(t!==i);return e}function Hr(i,t,e,n,s,r,o,a){return(s-o)*(t-a)>=(i-o)*(r-a)&&(i-o)*(n-a)>=(e-o)*(t-a)&&(e-o)*(r-a)>=(s-o)*(n-a)}function $S(i,t){return i.next.i!==t.i&&i.prev.i!==t.i&&!ZS(i,t)&&(Xo(i,t)&&Xo(t,i)&&JS(i,t)&&(Ye(i.prev,i,t.prev)||Ye(i,t.prev,t))||Wl(i,t)&&Ye(i.prev,i,i.next)>0&&Ye(t.prev,t,t.next)>0)}function Ye(i,t,e){return(t.y-i.y)*(e.x-t.x)-(t.x-i.x)*(e.y-t.y)}function Wl(i,t){return i.x===t.x&&i.y===t.y}function Tm(i,t,e,n){let s=Za(Ye(i,t,e)),r=Za(Ye(i,t,n)),o=Za(Ye(e,n,i)),a=Za(Ye(e,n,t));return!!(s!==r&&o!==a||s===0&&$a(i,e,t)||r===0&&$a(i,n,t)||o===0&&$a(e,i,n)||a===0&&$a(e,t,n))}function $a(i,t,e){return t.x<=Math.max(i.x,e.x)&&t.x>=Math.min(i.x,e.x)&&t.y<=Math.max(i.y,e.y)&&t.y>=Math.min(i.y,e.y)}function Za(i){return i>0?1:i<0?-1:0}function ZS(i,t){let e=i;do{if(e.i!==i.i&&e.next.i!==i.i&&e.i!==t.i&&e.next.i!==t.i&&Tm(e,e.next,i,t))return!0;e=e.next}while(e!==i);return!1}function Xo(i,t){return Ye(i.prev,i,i.next)<0?Ye(i,t,i.next)>=0&&Ye(i,i.prev,t)>=0:Ye(i,t,i.prev)<0||Ye(i,i.next,t)<0}function JS(i,t){let e=i,n=!1,s=(i.x+t.x)/2,r=(i.y+t.y)/2;do e.y>r!=e.next.y>r&&e.next.y!==e.y&&s<(e.next.x-e.x)*(r-e.y)/(e.next.y-e.y)+e.x&&(n=!n),e=e.next;while(e!==i);return n}function Am(i,t){let e=new Hu(i.i,i.x,i.y),n=new Hu(t.i,t.x,t.y),s=i.next,r=t.prev;return i.next=t,t.prev=i,e.next=s,s.prev=e,n.next=e,e.prev=n,r.next=n,n.prev=r,n}function qp(i,t,e,n){let s=new Hu(i,t,e);return n?(s.next=n.next,s.prev=n,n.next.prev=s,n.next=s):(s.prev=s,s.next=s),s}function qo(i){i.next.prev=i.prev,i.prev.next=i.next,i.prevZ&&(i.prevZ.nextZ=i.nextZ),i.nextZ&&(i.nextZ.prevZ=i.prevZ)}function Hu(i,t,e){this.i=i,this.x=t,this.y=e,this.prev=null,this.next=null,this.z=0,this.prevZ=null,this.nextZ=null,this.steiner=!1}function KS(i,t,e,n){let s=0;for(let r=t,o=e-n;r<e;r+=n)s+=(i[o]-i[r])*(i[r+1]+i[o+1]),o=r;return s}var Is=class i{static area(t){let e=t.length,n=0;for(let s=e-1,r=0;r<e;s=r++)n+=t[s].x*t[r].y-t[r].x*t[s].y;return n*.5}static isClockWise(t){return i.area(t)<0}static triangulateShape(t,e){let n=[],s=[],r=[];Yp(t),$p(n,t);let o=t.length;e.forEach(Yp);for(let l=0;l<e.length;l++)s.push(o),o+=e[l].length,$p(n,e[l]);let a=NS.triangulate(n,s);for(let l=0;l<a.length;l+=3)r.push(a.slice(l,l+3));return r}};function Yp(i){let t=i.length;t>2&&i[t-1].equals(i[0])&&i.pop()}function $p(i,t){for(let e=0;e<t.length;e++)i.push(t[e].x),i.push(t[e].y)}var Al=class i extends ve{constructor(t=new Us([new gt(.5,.5),new gt(-.5,.5),new gt(-.5,-.5),new gt(.5,-.5)]),e={}){super(),this.type="ExtrudeGeometry",this.parameters={shapes:t,options:e},t=Array.isArray(t)?t:[t];let n=this,s=[],r=[];for(let a=0,l=t.length;a<l;a++){let c=t[a];o(c)}this.setAttribute("position",new Qt(s,3)),this.setAttribute("uv",new Qt(r,2)),this.computeVertexNormals();function o(a){let l=[],c=e.curveSegments!==void 0?e.curveSegments:12,h=e.steps!==void 0?e.steps:1,f=e.depth!==void 0?e.depth:1,u=e.bevelEnabled!==void 0?e.bevelEnabled:!0,d=e.bevelThickness!==void 0?e.bevelThickness:.2,m=e.bevelSize!==void 0?e.bevelSize:d-.1,_=e.bevelOffset!==void 0?e.bevelOffset:0,g=e.bevelSegments!==void 0?e.bevelSegments:3,p=e.extrudePath,S=e.UVGenerator!==void 0?e.UVGenerator:jS,v,y=!1,U,R,P,F;p&&(v=p.getSpacedPoints(h),y=!0,u=!1,U=p.computeFrenetFrames(h,!1),R=new D,P=new D,F=new D),u||(g=0,d=0,m=0,_=0);let E=a.extractPoints(c),M=E.shape,A=E.holes;if(!Is.isClockWise(M)){M=M.reverse();for(let st=0,mt=A.length;st<mt;st++){let N=A[st];Is.isClockWise(N)&&(A[st]=N.reverse())}}let G=Is.triangulateShape(M,A),X=M;for(let st=0,mt=A.length;st<mt;st++){let N=A[st];M=M.concat(N)}function Z(st,mt,N){return mt||console.error("THREE.ExtrudeGeometry: vec does not exist"),st.clone().addScaledVector(mt,N)}let Y=M.length,nt=G.length;function Q(st,mt,N){let Vt,ut,Tt,xt=st.x-mt.x,Jt=st.y-mt.y,St=N.x-st.x,C=N.y-st.y,b=xt*xt+Jt*Jt,B=xt*C-Jt*St;if(Math.abs(B)>Number.EPSILON){let tt=Math.sqrt(b),j=Math.sqrt(St*St+C*C),et=mt.x-Jt/tt,Nt=mt.y+xt/tt,Mt=N.x-C/j,At=N.y+St/j,Kt=((Mt-et)*C-(At-Nt)*St)/(xt*C-Jt*St);Vt=et+xt*Kt-st.x,ut=Nt+Jt*Kt-st.y;let ct=Vt*Vt+ut*ut;if(ct<=2)return new gt(Vt,ut);Tt=Math.sqrt(ct/2)}else{let tt=!1;xt>Number.EPSILON?St>Number.EPSILON&&(tt=!0):xt<-Number.EPSILON?St<-Number.EPSILON&&(tt=!0):Math.sign(Jt)===Math.sign(C)&&(tt=!0),tt?(Vt=-Jt,ut=xt,Tt=Math.sqrt(b)):(Vt=xt,ut=Jt,Tt=Math.sqrt(b/2))}return new gt(Vt/Tt,ut/Tt)}let dt=[];for(let st=0,mt=X.length,N=mt-1,Vt=st+1;st<mt;st++,N++,Vt++)N===mt&&(N=0),Vt===mt&&(Vt=0),dt[st]=Q(X[st],X[N],X[Vt]);let at=[],_t,pt=dt.concat();for(let st=0,mt=A.length;st<mt;st++){let N=A[st];_t=[];for(let Vt=0,ut=N.length,Tt=ut-1,xt=Vt+1;Vt<ut;Vt++,Tt++,xt++)Tt===ut&&(Tt=0),xt===ut&&(xt=0),_t[Vt]=Q(N[Vt],N[Tt],N[xt]);at.push(_t),pt=pt.concat(_t)}for(let st=0;st<g;st++){let mt=st/g,N=d*Math.cos(mt*Math.PI/2),Vt=m*Math.sin(mt*Math.PI/2)+_;for(let ut=0,Tt=X.length;ut<Tt;ut++){let xt=Z(X[ut],dt[ut],Vt);lt(xt.x,xt.y,-N)}for(let ut=0,Tt=A.length;ut<Tt;ut++){let xt=A[ut];_t=at[ut];for(let Jt=0,St=xt.length;Jt<St;Jt++){let C=Z(xt[Jt],_t[Jt],Vt);lt(C.x,C.y,-N)}}}let Zt=m+_;for(let st=0;st<Y;st++){let mt=u?Z(M[st],pt[st],Zt):M[st];y?(P.copy(U.normals[0]).multiplyScalar(mt.x),R.copy(U.binormals[0]).multiplyScalar(mt.y),F.copy(v[0]).add(P).add(R),lt(F.x,F.y,F.z)):lt(mt.x,mt.y,0)}for(let st=1;st<=h;st++)for(let mt=0;mt<Y;mt++){let N=u?Z(M[mt],pt[mt],Zt):M[mt];y?(P.copy(U.normals[st]).multiplyScalar(N.x),R.copy(U.binormals[st]).multiplyScalar(N.y),F.copy(v[st]).add(P).add(R),lt(F.x,F.y,F.z)):lt(N.x,N.y,f/h*st)}for(let st=g-1;st>=0;st--){let mt=st/g,N=d*Math.cos(mt*Math.PI/2),Vt=m*Math.sin(mt*Math.PI/2)+_;for(let ut=0,Tt=X.length;ut<Tt;ut++){let xt=Z(X[ut],dt[ut],Vt);lt(xt.x,xt.y,f+N)}for(let ut=0,Tt=A.length;ut<Tt;ut++){let xt=A[ut];_t=at[ut];for(let Jt=0,St=xt.length;Jt<St;Jt++){let C=Z(xt[Jt],_t[Jt],Vt);y?lt(C.x,C.y+v[h-1].y,v[h-1].x+N):lt(C.x,C.y,f+N)}}}J(),ht();function J(){let st=s.length/3;if(u){let mt=0,N=Y*mt;for(let Vt=0;Vt<nt;Vt++){let ut=G[Vt];Ft(ut[2]+N,ut[1]+N,ut[0]+N)}mt=h+g*2,N=Y*mt;for(let Vt=0;Vt<nt;Vt++){let ut=G[Vt];Ft(ut[0]+N,ut[1]+N,ut[2]+N)}}else{for(let mt=0;mt<nt;mt++){let N=G[mt];Ft(N[2],N[1],N[0])}for(let mt=0;mt<nt;mt++){let N=G[mt];Ft(N[0]+Y*h,N[1]+Y*h,N[2]+Y*h)}}n.addGroup(st,s.length/3-st,0)}function ht(){let st=s.length/3,mt=0;Ot(X,mt),mt+=X.length;for(let N=0,Vt=A.length;N<Vt;N++){let ut=A[N];Ot(ut,mt),mt+=ut.length}n.addGroup(st,s.length/3-st,1)}function Ot(st,mt){let N=st.length;for(;--N>=0;){let Vt=N,ut=N-1;ut<0&&(ut=st.length-1);for(let Tt=0,xt=h+g*2;Tt<xt;Tt++){let Jt=Y*Tt,St=Y*(Tt+1),C=mt+Vt+Jt,b=mt+ut+Jt,B=mt+ut+St,tt=mt+Vt+St;Yt(C,b,B,tt)}}}function lt(st,mt,N){l.push(st),l.push(mt),l.push(N)}function Ft(st,mt,N){Ut(st),Ut(mt),Ut(N);let Vt=s.length/3,ut=S.generateTopUV(n,s,Vt-3,Vt-2,Vt-1);te(ut[0]),te(ut[1]),te(ut[2])}function Yt(st,mt,N,Vt){Ut(st),Ut(mt),Ut(Vt),Ut(mt),Ut(N),Ut(Vt);let ut=s.length/3,Tt=S.generateSideWallUV(n,s,ut-6,ut-3,ut-2,ut-1);te(Tt[0]),te(Tt[1]),te(Tt[3]),te(Tt[1]),te(Tt[2]),te(Tt[3])}function Ut(st){s.push(l[st*3+0]),s.push(l[st*3+1]),s.push(l[st*3+2])}function te(st){r.push(st.x),r.push(st.y)}}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}toJSON(){let t=super.toJSON(),e=this.parameters.shapes,n=this.parameters.options;return QS(e,n,t)}static fromJSON(t,e){let n=[];for(let r=0,o=t.shapes.length;r<o;r++){let a=e[t.shapes[r]];n.push(a)}let s=t.options.extrudePath;return s!==void 0&&(t.options.extrudePath=new Bu[s.type]().fromJSON(s)),new i(n,t.options)}},jS={generateTopUV:function(i,t,e,n,s){let r=t[e*3],o=t[e*3+1],a=t[n*3],l=t[n*3+1],c=t[s*3],h=t[s*3+1];return[new gt(r,o),new gt(a,l),new gt(c,h)]},generateSideWallUV:function(i,t,e,n,s,r){let o=t[e*3],a=t[e*3+1],l=t[e*3+2],c=t[n*3],h=t[n*3+1],f=t[n*3+2],u=t[s*3],d=t[s*3+1],m=t[s*3+2],_=t[r*3],g=t[r*3+1],p=t[r*3+2];return Math.abs(a-h)<Math.abs(o-c)?[new gt(o,1-l),new gt(c,1-f),new gt(u,1-m),new gt(_,1-p)]:[new gt(a,1-l),new gt(h,1-f),new gt(d,1-m),new gt(g,1-p)]}};function QS(i,t,e){if(e.shapes=[],Array.isArray(i))for(let n=0,s=i.length;n<s;n++){let r=i[n];e.shapes.push(r.uuid)}else e.shapes.push(i.uuid);return e.options=Object.assign({},t),t.extrudePath!==void 0&&(e.options.extrudePath=t.extrudePath.toJSON()),e}var Cl=class i extends ku{constructor(t=1,e=0){let n=(1+Math.sqrt(5))/2,s=[-1,n,0,1,n,0,-1,-n,0,1,-n,0,0,-1,n,0,1,n,0,-1,-n,0,1,-n,n,0,-1,n,0,1,-n,0,-1,-n,0,1],r=[0,11,5,0,5,1,0,1,7,0,7,10,0,10,11,1,5,9,5,11,4,11,10,2,10,7,6,7,1,8,3,9,4,3,4,2,3,2,6,3,6,8,3,8,9,4,9,5,2,4,11,6,2,10,8,6,7,9,8,1];super(s,r,t,e),this.type="IcosahedronGeometry",this.parameters={radius:t,detail:e}}static fromJSON(t){return new i(t.radius,t.detail)}};var Rl=class i extends ve{constructor(t=new Us([new gt(0,.5),new gt(-.5,-.5),new gt(.5,-.5)]),e=12){super(),this.type="ShapeGeometry",this.parameters={shapes:t,curveSegments:e};let n=[],s=[],r=[],o=[],a=0,l=0;if(Array.isArray(t)===!1)c(t);else for(let h=0;h<t.length;h++)c(t[h]),this.addGroup(a,l,h),a+=l,l=0;this.setIndex(n),this.setAttribute("position",new Qt(s,3)),this.setAttribute("normal",new Qt(r,3)),this.setAttribute("uv",new Qt(o,2));function c(h){let f=s.length/3,u=h.extractPoints(e),d=u.shape,m=u.holes;Is.isClockWise(d)===!1&&(d=d.reverse());for(let g=0,p=m.length;g<p;g++){let S=m[g];Is.isClockWise(S)===!0&&(m[g]=S.reverse())}let _=Is.triangulateShape(d,m);for(let g=0,p=m.length;g<p;g++){let S=m[g];d=d.concat(S)}for(let g=0,p=d.length;g<p;g++){let S=d[g];s.push(S.x,S.y,0),r.push(0,0,1),o.push(S.x,S.y)}for(let g=0,p=_.length;g<p;g++){let S=_[g],v=S[0]+f,y=S[1]+f,U=S[2]+f;n.push(v,y,U),l+=3}}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}toJSON(){let t=super.toJSON(),e=this.parameters.shapes;return tw(e,t)}static fromJSON(t,e){let n=[];for(let s=0,r=t.shapes.length;s<r;s++){let o=e[t.shapes[s]];n.push(o)}return new i(n,t.curveSegments)}};function tw(i,t){if(t.shapes=[],Array.isArray(i))for(let e=0,n=i.length;e<n;e++){let s=i[e];t.shapes.push(s.uuid)}else t.shapes.push(i.uuid);return t}var no=class i extends ve{constructor(t=1,e=32,n=16,s=0,r=Math.PI*2,o=0,a=Math.PI){super(),this.type="SphereGeometry",this.parameters={radius:t,widthSegments:e,heightSegments:n,phiStart:s,phiLength:r,thetaStart:o,thetaLength:a},e=Math.max(3,Math.floor(e)),n=Math.max(2,Math.floor(n));let l=Math.min(o+a,Math.PI),c=0,h=[],f=new D,u=new D,d=[],m=[],_=[],g=[];for(let p=0;p<=n;p++){let S=[],v=p/n,y=0;p===0&&o===0?y=.5/e:p===n&&l===Math.PI&&(y=-.5/e);for(let U=0;U<=e;U++){let R=U/e;f.x=-t*Math.cos(s+R*r)*Math.sin(o+v*a),f.y=t*Math.cos(o+v*a),f.z=t*Math.sin(s+R*r)*Math.sin(o+v*a),m.push(f.x,f.y,f.z),u.copy(f).normalize(),_.push(u.x,u.y,u.z),g.push(R+y,1-v),S.push(c++)}h.push(S)}for(let p=0;p<n;p++)for(let S=0;S<e;S++){let v=h[p][S+1],y=h[p][S],U=h[p+1][S],R=h[p+1][S+1];(p!==0||o>0)&&d.push(v,y,R),(p!==n-1||l<Math.PI)&&d.push(y,U,R)}this.setIndex(d),this.setAttribute("position",new Qt(m,3)),this.setAttribute("normal",new Qt(_,3)),this.setAttribute("uv",new Qt(g,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.radius,t.widthSegments,t.heightSegments,t.phiStart,t.phiLength,t.thetaStart,t.thetaLength)}};var Pl=class extends ve{constructor(t=null){if(super(),this.type="WireframeGeometry",this.parameters={geometry:t},t!==null){let e=[],n=new Set,s=new D,r=new D;if(t.index!==null){let o=t.attributes.position,a=t.index,l=t.groups;l.length===0&&(l=[{start:0,count:a.count,materialIndex:0}]);for(let c=0,h=l.length;c<h;++c){let f=l[c],u=f.start,d=f.count;for(let m=u,_=u+d;m<_;m+=3)for(let g=0;g<3;g++){let p=a.getX(m+g),S=a.getX(m+(g+1)%3);s.fromBufferAttribute(o,p),r.fromBufferAttribute(o,S),Zp(s,r,n)===!0&&(e.push(s.x,s.y,s.z),e.push(r.x,r.y,r.z))}}}else{let o=t.attributes.position;for(let a=0,l=o.count/3;a<l;a++)for(let c=0;c<3;c++){let h=3*a+c,f=3*a+(c+1)%3;s.fromBufferAttribute(o,h),r.fromBufferAttribute(o,f),Zp(s,r,n)===!0&&(e.push(s.x,s.y,s.z),e.push(r.x,r.y,r.z))}}this.setAttribute("position",new Qt(e,3))}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}};function Zp(i,t,e){let n=`${i.x},${i.y},${i.z}-${t.x},${t.y},${t.z}`,s=`${t.x},${t.y},${t.z}-${i.x},${i.y},${i.z}`;return e.has(n)===!0||e.has(s)===!0?!1:(e.add(n),e.add(s),!0)}var Il=class extends Ds{static get type(){return"MeshLambertMaterial"}constructor(t){super(),this.isMeshLambertMaterial=!0,this.color=new oe(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new oe(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=dm,this.normalScale=new gt(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ki,this.combine=sf,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.emissive.copy(t.emissive),this.emissiveMap=t.emissiveMap,this.emissiveIntensity=t.emissiveIntensity,this.bumpMap=t.bumpMap,this.bumpScale=t.bumpScale,this.normalMap=t.normalMap,this.normalMapType=t.normalMapType,this.normalScale.copy(t.normalScale),this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.flatShading=t.flatShading,this.fog=t.fog,this}};function Ja(i,t,e){return!i||!e&&i.constructor===t?i:typeof t.BYTES_PER_ELEMENT=="number"?new t(i):Array.prototype.slice.call(i)}function ew(i){return ArrayBuffer.isView(i)&&!(i instanceof DataView)}var io=class{constructor(t,e,n,s){this.parameterPositions=t,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new e.constructor(n),this.sampleValues=e,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(t){let e=this.parameterPositions,n=this._cachedIndex,s=e[n],r=e[n-1];n:{t:{let o;e:{i:if(!(t<s)){for(let a=n+2;;){if(s===void 0){if(t<r)break i;return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(r=s,s=e[++n],t<s)break t}o=e.length;break e}if(!(t>=r)){let a=e[1];t<a&&(n=2,r=a);for(let l=n-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===l)break;if(s=r,r=e[--n-1],t>=r)break t}o=n,n=0;break e}break n}for(;n<o;){let a=n+o>>>1;t<e[a]?o=a:n=a+1}if(s=e[n],r=e[n-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,r,s)}return this.interpolate_(n,r,t,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(t){let e=this.resultBuffer,n=this.sampleValues,s=this.valueSize,r=t*s;for(let o=0;o!==s;++o)e[o]=n[r+o];return e}interpolate_(){throw new Error("call to abstract method")}intervalChanged_(){}},Gu=class extends io{constructor(t,e,n,s){super(t,e,n,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:Xd,endingEnd:Xd}}intervalChanged_(t,e,n){let s=this.parameterPositions,r=t-2,o=t+1,a=s[r],l=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case qd:r=t,a=2*e-n;break;case Yd:r=s.length-2,a=e+s[r]-s[r+1];break;default:r=t,a=n}if(l===void 0)switch(this.getSettings_().endingEnd){case qd:o=t,l=2*n-e;break;case Yd:o=1,l=n+s[1]-s[0];break;default:o=t-1,l=e}let c=(n-e)*.5,h=this.valueSize;this._weightPrev=c/(e-a),this._weightNext=c/(l-n),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=this._offsetPrev,f=this._offsetNext,u=this._weightPrev,d=this._weightNext,m=(n-e)/(s-e),_=m*m,g=_*m,p=-u*g+2*u*_-u*m,S=(1+u)*g+(-1.5-2*u)*_+(-.5+u)*m+1,v=(-1-d)*g+(1.5+d)*_+.5*m,y=d*g-d*_;for(let U=0;U!==a;++U)r[U]=p*o[h+U]+S*o[c+U]+v*o[l+U]+y*o[f+U];return r}},Wu=class extends io{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=(n-e)/(s-e),f=1-h;for(let u=0;u!==a;++u)r[u]=o[c+u]*f+o[l+u]*h;return r}},Xu=class extends io{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t){return this.copySampleValue_(t-1)}},Si=class{constructor(t,e,n,s){if(t===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(e===void 0||e.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+t);this.name=t,this.times=Ja(e,this.TimeBufferType),this.values=Ja(n,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(t){let e=t.constructor,n;if(e.toJSON!==this.toJSON)n=e.toJSON(t);else{n={name:t.name,times:Ja(t.times,Array),values:Ja(t.values,Array)};let s=t.getInterpolation();s!==t.DefaultInterpolation&&(n.interpolation=s)}return n.type=t.ValueTypeName,n}InterpolantFactoryMethodDiscrete(t){return new Xu(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodLinear(t){return new Wu(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodSmooth(t){return new Gu(this.times,this.values,this.getValueSize(),t)}setInterpolation(t){let e;switch(t){case il:e=this.InterpolantFactoryMethodDiscrete;break;case pu:e=this.InterpolantFactoryMethodLinear;break;case Jc:e=this.InterpolantFactoryMethodSmooth;break}if(e===void 0){let n="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(t!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(n);return console.warn("THREE.KeyframeTrack:",n),this}return this.createInterpolant=e,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return il;case this.InterpolantFactoryMethodLinear:return pu;case this.InterpolantFactoryMethodSmooth:return Jc}}getValueSize(){return this.values.length/this.times.length}shift(t){if(t!==0){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]+=t}return this}scale(t){if(t!==1){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]*=t}return this}trim(t,e){let n=this.times,s=n.length,r=0,o=s-1;for(;r!==s&&n[r]<t;)++r;for(;o!==-1&&n[o]>e;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=n.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let t=!0,e=this.getValueSize();e-Math.floor(e)!==0&&(console.error("THREE.KeyframeTrack: Invalid value size in track.",this),t=!1);let n=this.times,s=this.values,r=n.length;r===0&&(console.error("THREE.KeyframeTrack: Track is empty.",this),t=!1);let o=null;for(let a=0;a!==r;a++){let l=n[a];if(typeof l=="number"&&isNaN(l)){console.error("THREE.KeyframeTrack: Time is not a valid number.",this,a,l),t=!1;break}if(o!==null&&o>l){console.error("THREE.KeyframeTrack: Out of order keys.",this,a,l,o),t=!1;break}o=l}if(s!==void 0&&ew(s))for(let a=0,l=s.length;a!==l;++a){let c=s[a];if(isNaN(c)){console.error("THREE.KeyframeTrack: Value is not a valid number.",this,a,c),t=!1;break}}return t}optimize(){let t=this.times.slice(),e=this.values.slice(),n=this.getValueSize(),s=this.getInterpolation()===Jc,r=t.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=t[a],h=t[a+1];if(c!==h&&(a!==1||c!==t[0]))if(s)l=!0;else{let f=a*n,u=f-n,d=f+n;for(let m=0;m!==n;++m){let _=e[f+m];if(_!==e[u+m]||_!==e[d+m]){l=!0;break}}}if(l){if(a!==o){t[o]=t[a];let f=a*n,u=o*n;for(let d=0;d!==n;++d)e[u+d]=e[f+d]}++o}}if(r>0){t[o]=t[r];for(let a=r*n,l=o*n,c=0;c!==n;++c)e[l+c]=e[a+c];++o}return o!==t.length?(this.times=t.slice(0,o),this.values=e.slice(0,o*n)):(this.times=t,this.values=e),this}clone(){let t=this.times.slice(),e=this.values.slice(),n=this.constructor,s=new n(this.name,t,e);return s.createInterpolant=this.createInterpolant,s}};Si.prototype.TimeBufferType=Float32Array;Si.prototype.ValueBufferType=Float32Array;Si.prototype.DefaultInterpolation=pu;var sr=class extends Si{constructor(t,e,n){super(t,e,n)}};sr.prototype.ValueTypeName="bool";sr.prototype.ValueBufferType=Array;sr.prototype.DefaultInterpolation=il;sr.prototype.InterpolantFactoryMethodLinear=void 0;sr.prototype.InterpolantFactoryMethodSmooth=void 0;var qu=class extends Si{};qu.prototype.ValueTypeName="color";var Yu=class extends Si{};Yu.prototype.ValueTypeName="number";var $u=class extends io{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(n-e)/(s-e),c=t*a;for(let h=c+a;c!==h;c+=4)kn.slerpFlat(r,0,o,c-a,o,c,l);return r}},Ll=class extends Si{InterpolantFactoryMethodLinear(t){return new $u(this.times,this.values,this.getValueSize(),t)}};Ll.prototype.ValueTypeName="quaternion";Ll.prototype.InterpolantFactoryMethodSmooth=void 0;var rr=class extends Si{constructor(t,e,n){super(t,e,n)}};rr.prototype.ValueTypeName="string";rr.prototype.ValueBufferType=Array;rr.prototype.DefaultInterpolation=il;rr.prototype.InterpolantFactoryMethodLinear=void 0;rr.prototype.InterpolantFactoryMethodSmooth=void 0;var Zu=class extends Si{};Zu.prototype.ValueTypeName="vector";var Ju=class{constructor(t,e,n){let s=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=t,this.onProgress=e,this.onError=n,this.itemStart=function(h){a++,r===!1&&s.onStart!==void 0&&s.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,s.onProgress!==void 0&&s.onProgress(h,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(h){s.onError!==void 0&&s.onError(h)},this.resolveURL=function(h){return l?l(h):h},this.setURLModifier=function(h){return l=h,this},this.addHandler=function(h,f){return c.push(h,f),this},this.removeHandler=function(h){let f=c.indexOf(h);return f!==-1&&c.splice(f,2),this},this.getHandler=function(h){for(let f=0,u=c.length;f<u;f+=2){let d=c[f],m=c[f+1];if(d.global&&(d.lastIndex=0),d.test(h))return m}return null}}},nw=new Ju,Ku=class{constructor(t){this.manager=t!==void 0?t:nw,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={}}load(){}loadAsync(t,e){let n=this;return new Promise(function(s,r){n.load(t,s,e,r)})}parse(){}setCrossOrigin(t){return this.crossOrigin=t,this}setWithCredentials(t){return this.withCredentials=t,this}setPath(t){return this.path=t,this}setResourcePath(t){return this.resourcePath=t,this}setRequestHeader(t){return this.requestHeader=t,this}};Ku.DEFAULT_MATERIAL_NAME="__DEFAULT";var Dl=class extends En{constructor(t,e=1){super(),this.isLight=!0,this.type="Light",this.color=new oe(t),this.intensity=e}dispose(){}copy(t,e){return super.copy(t,e),this.color.copy(t.color),this.intensity=t.intensity,this}toJSON(t){let e=super.toJSON(t);return e.object.color=this.color.getHex(),e.object.intensity=this.intensity,this.groundColor!==void 0&&(e.object.groundColor=this.groundColor.getHex()),this.distance!==void 0&&(e.object.distance=this.distance),this.angle!==void 0&&(e.object.angle=this.angle),this.decay!==void 0&&(e.object.decay=this.decay),this.penumbra!==void 0&&(e.object.penumbra=this.penumbra),this.shadow!==void 0&&(e.object.shadow=this.shadow.toJSON()),this.target!==void 0&&(e.object.target=this.target.uuid),e}},Ul=class extends Dl{constructor(t,e,n){super(t,n),this.isHemisphereLight=!0,this.type="HemisphereLight",this.position.copy(En.DEFAULT_UP),this.updateMatrix(),this.groundColor=new oe(e)}copy(t,e){return super.copy(t,e),this.groundColor.copy(t.groundColor),this}},Ch=new ze,Jp=new D,Kp=new D,ju=class{constructor(t){this.camera=t,this.intensity=1,this.bias=0,this.normalBias=0,this.radius=1,this.blurSamples=8,this.mapSize=new gt(512,512),this.map=null,this.mapPass=null,this.matrix=new ze,this.autoUpdate=!0,this.needsUpdate=!1,this._frustum=new Vo,this._frameExtents=new gt(1,1),this._viewportCount=1,this._viewports=[new De(0,0,1,1)]}getViewportCount(){return this._viewportCount}getFrustum(){return this._frustum}updateMatrices(t){let e=this.camera,n=this.matrix;Jp.setFromMatrixPosition(t.matrixWorld),e.position.copy(Jp),Kp.setFromMatrixPosition(t.target.matrixWorld),e.lookAt(Kp),e.updateMatrixWorld(),Ch.multiplyMatrices(e.projectionMatrix,e.matrixWorldInverse),this._frustum.setFromProjectionMatrix(Ch),n.set(.5,0,0,.5,0,.5,0,.5,0,0,.5,.5,0,0,0,1),n.multiply(Ch)}getViewport(t){return this._viewports[t]}getFrameExtents(){return this._frameExtents}dispose(){this.map&&this.map.dispose(),this.mapPass&&this.mapPass.dispose()}copy(t){return this.camera=t.camera.clone(),this.intensity=t.intensity,this.bias=t.bias,this.radius=t.radius,this.mapSize.copy(t.mapSize),this}clone(){return new this.constructor().copy(this)}toJSON(){let t={};return this.intensity!==1&&(t.intensity=this.intensity),this.bias!==0&&(t.bias=this.bias),this.normalBias!==0&&(t.normalBias=this.normalBias),this.radius!==1&&(t.radius=this.radius),(this.mapSize.x!==512||this.mapSize.y!==512)&&(t.mapSize=this.mapSize.toArray()),t.camera=this.camera.toJSON(!1).object,delete t.camera.matrix,t}};var Qu=class extends ju{constructor(){super(new eo(-5,5,5,-5,.5,500)),this.isDirectionalLightShadow=!0}},Nl=class extends Dl{constructor(t,e){super(t,e),this.isDirectionalLight=!0,this.type="DirectionalLight",this.position.copy(En.DEFAULT_UP),this.updateMatrix(),this.target=new En,this.shadow=new Qu}dispose(){this.shadow.dispose()}copy(t){return super.copy(t),this.target=t.target.clone(),this.shadow=t.shadow.clone(),this}};var Fl=class extends ve{constructor(){super(),this.isInstancedBufferGeometry=!0,this.type="InstancedBufferGeometry",this.instanceCount=1/0}copy(t){return super.copy(t),this.instanceCount=t.instanceCount,this}toJSON(){let t=super.toJSON();return t.instanceCount=this.instanceCount,t.isInstancedBufferGeometry=!0,t}};var pf="\\[\\]\\.:\\/",iw=new RegExp("["+pf+"]","g"),mf="[^"+pf+"]",sw="[^"+pf.replace("\\.","")+"]",rw=/((?:WC+[\/:])*)/.source.replace("WC",mf),ow=/(WCOD+)?/.source.replace("WCOD",sw),aw=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",mf),lw=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",mf),cw=new RegExp("^"+rw+ow+aw+lw+"$"),hw=["material","materials","bones","map"],tf=class{constructor(t,e,n){let s=n||qe.parseTrackName(e);this._targetGroup=t,this._bindings=t.subscribe_(e,s)}getValue(t,e){this.bind();let n=this._targetGroup.nCachedObjects_,s=this._bindings[n];s!==void 0&&s.getValue(t,e)}setValue(t,e){let n=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=n.length;s!==r;++s)n[s].setValue(t,e)}bind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].bind()}unbind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].unbind()}},qe=class i{constructor(t,e,n){this.path=e,this.parsedPath=n||i.parseTrackName(e),this.node=i.findNode(t,this.parsedPath.nodeName),this.rootNode=t,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(t,e,n){return t&&t.isAnimationObjectGroup?new i.Composite(t,e,n):new i(t,e,n)}static sanitizeNodeName(t){return t.replace(/\s/g,"_").replace(iw,"")}static parseTrackName(t){let e=cw.exec(t);if(e===null)throw new Error("PropertyBinding: Cannot parse trackName: "+t);let n={nodeName:e[2],objectName:e[3],objectIndex:e[4],propertyName:e[5],propertyIndex:e[6]},s=n.nodeName&&n.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=n.nodeName.substring(s+1);hw.indexOf(r)!==-1&&(n.nodeName=n.nodeName.substring(0,s),n.objectName=r)}if(n.propertyName===null||n.propertyName.length===0)throw new Error("PropertyBinding: can not parse propertyName from trackName: "+t);return n}static findNode(t,e){if(e===void 0||e===""||e==="."||e===-1||e===t.name||e===t.uuid)return t;if(t.skeleton){let n=t.skeleton.getBoneByName(e);if(n!==void 0)return n}if(t.children){let n=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===e||a.uuid===e)return a;let l=n(a.children);if(l)return l}return null},s=n(t.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(t,e){t[e]=this.targetObject[this.propertyName]}_getValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)t[e++]=n[s]}_getValue_arrayElement(t,e){t[e]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(t,e){this.resolvedProperty.toArray(t,e)}_setValue_direct(t,e){this.targetObject[this.propertyName]=t[e]}_setValue_direct_setNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++]}_setValue_array_setNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(t,e){this.resolvedProperty[this.propertyIndex]=t[e]}_setValue_arrayElement_setNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(t,e){this.resolvedProperty.fromArray(t,e)}_setValue_fromArray_setNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(t,e){this.bind(),this.getValue(t,e)}_setValue_unbound(t,e){this.bind(),this.setValue(t,e)}bind(){let t=this.node,e=this.parsedPath,n=e.objectName,s=e.propertyName,r=e.propertyIndex;if(t||(t=i.findNode(this.rootNode,e.nodeName),this.node=t),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!t){console.warn("THREE.PropertyBinding: No target node found for track: "+this.path+".");return}if(n){let c=e.objectIndex;switch(n){case"materials":if(!t.material){console.error("THREE.PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.materials){console.error("THREE.PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}t=t.material.materials;break;case"bones":if(!t.skeleton){console.error("THREE.PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}t=t.skeleton.bones;for(let h=0;h<t.length;h++)if(t[h].name===c){c=h;break}break;case"map":if("map"in t){t=t.map;break}if(!t.material){console.error("THREE.PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.map){console.error("THREE.PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}t=t.material.map;break;default:if(t[n]===void 0){console.error("THREE.PropertyBinding: Can not bind to objectName of node undefined.",this);return}t=t[n]}if(c!==void 0){if(t[c]===void 0){console.error("THREE.PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,t);return}t=t[c]}}let o=t[s];if(o===void 0){let c=e.nodeName;console.error("THREE.PropertyBinding: Trying to update property for track: "+c+"."+s+" but it wasn't found.",t);return}let a=this.Versioning.None;this.targetObject=t,t.needsUpdate!==void 0?a=this.Versioning.NeedsUpdate:t.matrixWorldNeedsUpdate!==void 0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!t.geometry){console.error("THREE.PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!t.geometry.morphAttributes){console.error("THREE.PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}t.morphTargetDictionary[r]!==void 0&&(r=t.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};qe.Composite=tf;qe.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};qe.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};qe.prototype.GetterByBindingType=[qe.prototype._getValue_direct,qe.prototype._getValue_array,qe.prototype._getValue_arrayElement,qe.prototype._getValue_toArray];qe.prototype.SetterByBindingTypeAndVersioning=[[qe.prototype._setValue_direct,qe.prototype._setValue_direct_setNeedsUpdate,qe.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[qe.prototype._setValue_array,qe.prototype._setValue_array_setNeedsUpdate,qe.prototype._setValue_array_setMatrixWorldNeedsUpdate],[qe.prototype._setValue_arrayElement,qe.prototype._setValue_arrayElement_setNeedsUpdate,qe.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[qe.prototype._setValue_fromArray,qe.prototype._setValue_fromArray_setNeedsUpdate,qe.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var eA=new Float32Array(1);var or=class extends Lu{constructor(t,e,n=1){super(t,e),this.isInstancedInterleavedBuffer=!0,this.meshPerAttribute=n}copy(t){return super.copy(t),this.meshPerAttribute=t.meshPerAttribute,this}clone(t){let e=super.clone(t);return e.meshPerAttribute=this.meshPerAttribute,e}toJSON(t){let e=super.toJSON(t);return e.isInstancedInterleavedBuffer=!0,e.meshPerAttribute=this.meshPerAttribute,e}};var jp=new ze,Ol=class{constructor(t,e,n=0,s=1/0){this.ray=new nr(t,e),this.near=n,this.far=s,this.camera=null,this.layers=new ko,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(t,e){this.ray.set(t,e)}setFromCamera(t,e){e.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(t.x,t.y,.5).unproject(e).sub(this.ray.origin).normalize(),this.camera=e):e.isOrthographicCamera?(this.ray.origin.set(t.x,t.y,(e.near+e.far)/(e.near-e.far)).unproject(e),this.ray.direction.set(0,0,-1).transformDirection(e.matrixWorld),this.camera=e):console.error("THREE.Raycaster: Unsupported camera type: "+e.type)}setFromXRController(t){return jp.identity().extractRotation(t.matrixWorld),this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(jp),this}intersectObject(t,e=!0,n=[]){return ef(t,this,n,e),n.sort(Qp),n}intersectObjects(t,e=!0,n=[]){for(let s=0,r=t.length;s<r;s++)ef(t[s],this,n,e);return n.sort(Qp),n}};function Qp(i,t){return i.distance-t.distance}function ef(i,t,e,n){let s=!0;if(i.layers.test(t.layers)&&i.raycast(t,e)===!1&&(s=!1),s===!0&&n===!0){let r=i.children;for(let o=0,a=r.length;o<a;o++)ef(r[o],t,e,!0)}}var ar=class{constructor(t=1,e=0,n=0){return this.radius=t,this.phi=e,this.theta=n,this}set(t,e,n){return this.radius=t,this.phi=e,this.theta=n,this}copy(t){return this.radius=t.radius,this.phi=t.phi,this.theta=t.theta,this}makeSafe(){return this.phi=Math.max(1e-6,Math.min(Math.PI-1e-6,this.phi)),this}setFromVector3(t){return this.setFromCartesianCoords(t.x,t.y,t.z)}setFromCartesianCoords(t,e,n){return this.radius=Math.sqrt(t*t+e*e+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(t,n),this.phi=Math.acos(nn(e/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var tm=new D,Ka=new D,so=class{constructor(t=new D,e=new D){this.start=t,this.end=e}set(t,e){return this.start.copy(t),this.end.copy(e),this}copy(t){return this.start.copy(t.start),this.end.copy(t.end),this}getCenter(t){return t.addVectors(this.start,this.end).multiplyScalar(.5)}delta(t){return t.subVectors(this.end,this.start)}distanceSq(){return this.start.distanceToSquared(this.end)}distance(){return this.start.distanceTo(this.end)}at(t,e){return this.delta(e).multiplyScalar(t).add(this.start)}closestPointToPointParameter(t,e){tm.subVectors(t,this.start),Ka.subVectors(this.end,this.start);let n=Ka.dot(Ka),r=Ka.dot(tm)/n;return e&&(r=nn(r,0,1)),r}closestPointToPoint(t,e,n){let s=this.closestPointToPointParameter(t,e);return this.delta(n).multiplyScalar(s).add(this.start)}applyMatrix4(t){return this.start.applyMatrix4(t),this.end.applyMatrix4(t),this}equals(t){return t.start.equals(this.start)&&t.end.equals(this.end)}clone(){return new this.constructor().copy(this)}};var Bl=class extends cs{constructor(t,e=null){super(),this.object=t,this.domElement=e,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(){}disconnect(){}dispose(){}update(){}};typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:nf}}));typeof window<"u"&&(window.__THREE__?console.warn("WARNING: Multiple instances of Three.js being imported."):window.__THREE__=nf);function ce(i,t=new D){return t.set(i[1],-i[2],-i[0])}function Cm(i){return[-i.z,i.x,-i.y]}function Ei(i,t=new kn){return t.set(i[2],-i[3],-i[1],i[0])}function gf(i){return new kn().setFromAxisAngle(new D(0,-1,0),i)}function Rm(i){return new D(i[1],i[2],i[0])}var uw=9,fw=2,dw=.2,pw=1,mw=.36,gw=.4,_w=60,xw=6;function Pm(i,t){let e=O("div",{id:"film-time"});document.documentElement.classList.add("film"),document.body.append(e);for(let{label:s}of i.obstacles.obstacles)s.visible=i.obstacles.obstacles.length<=xw;i.panel.key.open=!1,i.setCamera(t==="follow"||t==="top"?t:"free"),i.resize();let n=yw(i);return s=>{if(e.textContent=`${s.toFixed(1)} s`,t==="around"){let r=n+gw*Math.sin(2*Math.PI*(s-i.run.meta.begin)/_w);i.cameras.frame(vw(i,s),new D(Math.cos(r),mw,Math.sin(r)).normalize())}i.renderAt(s)}}function yw({run:i}){let{t,series:[e,n]}=i.flown("position"),s=f=>t.reduce((u,d,m)=>u+(f(m)||0),0)/t.length,[r,o]=[s(f=>e[f]),s(f=>n[f])],[a,l,c]=[s(f=>(e[f]-r)**2),s(f=>(n[f]-o)**2),s(f=>(e[f]-r)*(n[f]-o))];return Math.atan2(-2*c,l-a)/2+Math.PI/2}function vw({run:i,cameras:{corners:t}},e){let n=ce(i.flown("position").at(e)),s=["x","z"].map(r=>{let[o,a]=[t[0][r],t[7][r]].sort((u,d)=>u-d),l=(a-o)/2,c=Math.min(fw,dw*l),h=Math.min(uw,l-c),f=Math.min(Math.max(n[r],o+c+h),a-c-h);return[f-h,f+h]});return t.map((r,o)=>new D(s[0][o&1],r.y>0?r.y+pw:0,s[1][o>>2&1]))}var Mw=.1,hA=180/Math.PI;function _f(i,t,e){let n=new Array(e.length).fill(null);if(i.length===0)return n;let s=0;for(let r=0;r<e.length;r+=1){let o=e[r];if(o<i[0]-1e-6||o>i[i.length-1]+1e-6)continue;for(;s+1<i.length&&i[s+1]<=o;)s+=1;let a=t[s];if(s+1<i.length&&o>i[s]){if(i[s+1]-i[s]>1)continue;a+=(o-i[s])/(i[s+1]-i[s])*(t[s+1]-t[s])}Number.isFinite(a)&&(n[r]=a)}return n}function $e(i,t){return i.series.map(e=>_f(i.t,e,t))}function $o(i,t){return i[0].map((e,n)=>{let s=0;for(let r=0;r<3;r+=1){if(i[r][n]===null||t[r][n]===null)return null;s+=(i[r][n]-t[r][n])**2}return Math.sqrt(s)})}function xf(i){let t=[0,1,2].map(()=>new Float32Array(i.t.length));for(let e=0;e<i.t.length;e+=1){let n=Bd(i.row(e));for(let s=0;s<3;s+=1)t[s][e]=n[s]}return t}function Xl(i){let t=i.flown("position"),e=i.channel("reference.position");if(!t||!e)return null;let n=i.channel("plan.position"),{t:s}=t,[r,o]=[$e(t,s),$e(e,s)],a=n?$e(n,s):o,l=$o(a,o),c=$o(r,a),h=$o(r,o),f=u=>u.reduce((d,m)=>m!==null&&m>(d??-1)?m:d,null);return{t:s,error:c,deviation:h,avoiding:n?ql(s,l.map(u=>u!==null&&u>Mw)):[],errorMax:f(c),deviationMax:f(n?h.map((u,d)=>c[d]===null?null:u):h)}}function Im(i){let[t,e]=[0,0];for(let n of i)n!==null&&(t+=n*n,e+=1);return e?Math.sqrt(t/e):null}function ql(i,t){let e=[];for(let n=0;n<i.length;n+=1){if(!t[n])continue;let s=i[n];for(;n+1<i.length&&t[n+1];)n+=1;e.push([s,i[Math.min(n+1,i.length-1)]])}return e}function yf(i,t){let e=t.source.split(", "),n=(t.end??i.meta.end)+5;return i.events.filter(s=>(s.kind==="alarm"||s.kind==="isolation")&&s.start>=t.start&&s.start<=n&&(e.includes(s.source)||t.source==="all vehicles"||s.source==="team"))}var bw={completed:"Every waypoint and the landing were reached, and the payload was set down.",interrupted:"The user ended the flight; the payload was set down.",aborted:"A failsafe ended the flight early, and the payload was set down.",failed:"A waypoint or the landing was missed, or the payload was not set down safely.",lost:"The records end without the vehicles being known to be on the ground.",collided:"Something touched: a vehicle or the payload came into contact.","in flight":"The flight is going on.","connection lost":"The connection to the flight was lost; this is what had come until then. Open the page again, or see the run folder.","no ground station":"The simulator by itself: no ground station has records in this folder.","cut off":"The records end before the flight does."};function vf({meta:{summary:i}}){return i.result?i.result.filter(({limit:t})=>t!==null):Object.entries(i.limits??{}).map(([t,e])=>({name:t,what:t.replaceAll("_"," "),unit:"",bound:"",...e}))}function Lm(i){let{outcome:t,summary:e}=i.meta;if(t==="in flight")return"live";if(["failed","lost","collided"].includes(t))return"bad";let n=Object.values(e.limits??{}).every(s=>s.held);return t==="completed"&&n?"good":"warning"}function Dm(i){let{meta:t}=i,n=[t.outcome==="aborted"&&!t.summary.duration_s?"The flight was refused before take-off.":bw[t.outcome]??""];t.reason&&n.push(`Reason: ${t.reason}.`);let s=t.summary.duration_s,r=`${t.vehicles} vehicles carried the payload`;return s&&n.push(`${r} for ${ue(s,0)} s${t.seed===null?"":` (seed ${t.seed})`}.`),t.source==="estimate"&&n.push("No truth is on record: all that is shown is the estimate of the ground, which can be wrong."),n}function Um(i){let{summary:t,margin:e}=i.meta,n=[],s=t.contacts;if(s!=null){let l=i.events.find(({kind:h})=>h==="contact"),c=l?`, from ${ue(l.start,1)} s on`:"";n.push(s===0?"Nothing touched.":`NOT safe: there ${s===1?"was 1 contact":`were ${s} contacts`}${c}.`)}let r=i.clearance;if(i.meta.outcome==="in flight"){let l=Array.from(i.channel("clearance.nearest")?.series[0]??[]).filter(Number.isFinite);l.length?n.push(`So far the formation's hull kept at least ${ue(l.reduce((c,h)=>Math.min(c,h)))} m from obstacles and fence.`):n.push(i.meta.source==="truth"?"So far nothing is known that it must keep clear of.":"The distance from obstacles is known where the truth is on record.")}else if(r){let l=t.limits?.clearance,c=l?l.limit:e,h=r.min-c,f=l?`the limit of ${ue(c)} m`:`the margin of ${ue(c)} m that plans keep`,u=`“${r.obstacle}”, at ${ue(r.time,1)} s`;if(r.min<=1e-6)n.push(`The formation met ${u}.`);else{let d=`${ue(Math.abs(h))} m ${h>=0?"more":"LESS"} than ${f}`;n.push(`The formation's hull kept at least ${ue(r.min)} m from ${u}: ${d}.`)}}else i.meta.source==="truth"&&n.push("There was no obstacle or fence to keep clear of.");Number.isFinite(t.uav_separation_min_m)&&t.uav_separation_min_m!==null&&n.push(`Two UAVs came as near as ${ue(t.uav_separation_min_m)} m, between their centres.`);let o=t.safety;if(o&&o.steps){let l=100*o.verified_steps/o.steps,c=o.verified_steps===o.steps?"100":ue(Math.min(l,99.9),1);n.push(`${c} % of the plans were verified to keep the margin of ${ue(e)} m by exact distances${o.unverified_reason?`; the worst other did not: ${o.unverified_reason}`:""}.`);for(let[h,f]of Object.entries(o.exceeded??{})){let u=h.replaceAll("_"," "),d=Number.isFinite(f.time_s)?` at ${ue(f.time_s,1)} s`:"";n.push(`The guarantee did not hold: ${u} was ${ue(f.value,3)} m${d} (limit ${ue(f.limit,3)} m).`)}}let a=vf(i).filter(({held:l})=>!l).map(({what:l})=>l);return a.length&&n.push(`Outside the mission's limits: ${a.join(", ")} (see Limits).`),n}function Nm(i){let t=[],e=Xl(i);if(!e)return["No reference is on record."];let n=e.avoiding.length>0,s=e.t,r=e.deviation.filter((o,a)=>e.error[a]!==null&&!e.avoiding.some(([l,c])=>s[a]>=l&&s[a]<=c));if(i.has("plan.position")){let o=i.meta.summary.safety?.payload_tracking_max_m??e.errorMax;t.push(`Error: the payload kept within ${ue(o,3)} m of its plan.`)}if(n){let o=e.avoiding.reduce((l,[c,h])=>l+h-c,0);t.push(`Avoidance: for ${ue(o,0)} s the plan left the mission's reference, to avoid obstacles or to wait for what comes, by up to ${ue(e.deviationMax)} m.`);let a=Im(r);a!==null&&t.push(`Otherwise the payload was ${ue(a,3)} m (RMS) from the reference.`)}else e.deviationMax!==null&&t.push(`The plan stayed on the mission's reference; the payload was at most ${ue(e.deviationMax,3)} m from it.`);return t}function Fm(i){let t=new Map;for(let e of i.events)e.kind==="mode"&&t.set(e.text,[...t.get(e.text)??[],e]);return[...t].map(([e,n])=>{let s=[...new Set(n.map(({source:o})=>o.replace("vehicle ","")))];return{text:`${s.length>1?`Vehicles ${s.slice(0,-1).join(", ")} and ${s.at(-1)} flew by themselves`:`Vehicle ${s[0]} flew by itself`} from ${ue(n[0].start,1)} s: ${e}.`,event:n[0]}})}function Om(i){let t=i.events.filter(n=>n.kind==="fault").map(n=>{let s=yf(i,n),[r]=s.filter(c=>c.kind==="alarm"),o=s.filter(c=>c.kind==="isolation"),a=`${ue(n.start,1)} s to ${n.end===null?"the end":`${ue(n.end,1)} s`}`,l=`${n.source}, ${n.text}, ${a}: `;l+=r?`first alarm ${ue(r.start-n.start)} s later (${r.text}, ${r.source})`:"no alarm";for(let c of o)l+=`; ${c.text} of ${c.source} isolated after ${ue(c.start-n.start)} s`,n.end!==null&&c.start>n.end&&(l+=", when the fault was over"),l+=c.end===null?"":`, used again from ${ue(c.end,1)} s`;return{text:`${l}.`,event:n}}),e=new Set(i.events.filter(n=>n.kind==="fault").flatMap(n=>yf(i,n)));for(let n of i.events)if(n.kind==="isolation"&&!e.has(n)){let s=n.end===null?"to the end":`until ${ue(n.end,1)} s`,r=`${n.text} of ${n.source} was isolated from ${ue(n.start,1)} s ${s}, without a fault.`;t.push({text:r,event:n})}return t}var Sw={good:"✓",warning:"!",bad:"✗",live:"●"};function Bm(i){let{meta:t}=i,e=Lm(i),n=t.outcome==="completed"&&e!=="good"?", outside its limits":"";return O("h1",{},t.mission,O("span.seed",{},t.seed===null?"":` seed ${t.seed}`),O(`span.badge.${e}`,{},`${Sw[e]} ${t.outcome}${n}`))}function zm(i,t){return O("div.cards",{tabIndex:0,role:"region","aria-label":"what happened"},Zo("What happened",Dm(i)),Zo("Was it safe?",Um(i),...ww(i,t)),Ew(i,t),Zo("Position: error and avoidance",Nm(i)),Tw(i),Aw(i.meta.command))}function Zo(i,t,...e){return O("section.card",{},O("h2",{},i),...t.map(n=>O("p",{},n)),...e)}function ww(i,t){let e=i.events.find(({kind:n})=>n==="contact");return[e&&Mf(t,e.start,"show the first contact"),e&&i.clearance&&", ",i.clearance&&Mf(t,i.clearance.time,"show the least clearance")]}function Mf(i,t,e){return O("button.link",{type:"button",onclick:()=>i.set(t)},e)}function Ew(i,t){let e=[...Om(i),...Fm(i)],n=i.events.filter(o=>o.kind==="alarm").length,s=n?`${n} alarms are in the list of events.`:"No alarm was raised.";if(!e.length)return Zo("Faults, failsafes, refused sensors",["No fault was injected and no channel isolated.",s]);let r=e.map(({text:o,event:a})=>O("li",{},`${o} `,Mf(t,a.start,"show")));return O("section.card",{},O("h2",{},"Faults, failsafes, refused sensors"),O("ul",{},...r),O("p",{},s))}function Tw(i){if(i.meta.outcome==="in flight")return null;let t=vf(i);if(!t.length)return Zo("Limits",["The mission has no limits on record."]);let e=t.map(({what:n,value:s,unit:r,bound:o,limit:a,held:l})=>{let c=r==="deg"?"°":r,h=s===null?"none":`${ue(s,c==="°"?1:3)} ${c}`;return O("tr",{},O("td",{},n),O("td.number",{},h),O("td.number",{},`${o} ${a} ${c}`),O(`td.${l?"held":"missed"}`,{},l?"✓ held":"✗ NOT held"))});return O("section.card",{},O("h2",{},"Limits"),O("table",{},O("tbody",{},...e)))}function Aw(i){if(!i)return null;let t=ya(i,"copy");return O("section.card",{},O("h2",{},"Fly it again"),O("div.command",{},O("code",{},i),t))}function km(i,t){if(!t)return null;let[e,n]=[i.meta.summary,t.meta.summary],s=[["position error, RMS (m)",e.position_rmse_m?.total,n.position_rmse_m?.total,3],["least clearance (m)",e.clearance_min_m,n.clearance_min_m,3],["UAV separation (m)",e.uav_separation_min_m,n.uav_separation_min_m,3],["largest roll (°)",e.payload_tilt_max_deg?.roll,n.payload_tilt_max_deg?.roll,2],["largest pitch (°)",e.payload_tilt_max_deg?.pitch,n.payload_tilt_max_deg?.pitch,2],["duration (s)",e.duration_s,n.duration_s,1],["contacts",e.contacts,n.contacts,0],["alarms",e.alarms,n.alarms,0],["control step, median (ms)",e.step_time_ms?.p50,n.step_time_ms?.p50,1]],r=c=>c!=null,o=s.map(([c,h,f,u])=>O("tr",{},O("td",{},c),O("td.number",{},r(h)?ue(h,u):"–"),O("td.number",{},r(f)?ue(f,u):"–"),O("td.number",{},r(h)&&r(f)?(f-h>0?"+":"")+ue(f-h,u):"–"))),a=["",`A: ${i.meta.run}`,`B: ${t.meta.run}`,"B − A"].map(c=>O("th",{},c)),l=O("tr",{},O("td",{},"outcome"),O("td.number",{},i.meta.outcome),O("td.number",{},t.meta.outcome),O("td",{}));return O("section.card",{},O("h2",{},"Two runs"),O("p",{},"A is what the page is about; B is its ghost in the scene and the dashed curves of the plots."),O("div.scroll.flat",{},O("table",{},O("thead",{},O("tr",{},...a)),O("tbody",{},l,...o))))}var cn="u-",Cw="uplot",Rw=cn+"hz",Pw=cn+"vt",Iw=cn+"title",Lw=cn+"wrap",Dw=cn+"under",Uw=cn+"over",Nw=cn+"axis",hr=cn+"off",Fw=cn+"select",Ow=cn+"cursor-x",Bw=cn+"cursor-y",zw=cn+"cursor-pt",kw=cn+"legend",Vw=cn+"live",Hw=cn+"inline",Gw=cn+"series",Ww=cn+"marker",Vm=cn+"label",Xw=cn+"value",jo="width",Qo="height",Jo="top",Hm="bottom",ao="left",bf="right",Bf="#000",Gm=Bf+"0",Wm="mousemove",Xm="mousedown",Sf="mouseup",qm="mouseenter",Ym="mouseleave",$m="dblclick",qw="resize",Yw="scroll",Zm="change",Kl="dppxchange",zf="--",go=typeof window<"u",Cf=go?document:null,co=go?window:null,$w=go?navigator:null,Ee,Yl;function Rf(){let i=devicePixelRatio;Ee!=i&&(Ee=i,Yl&&If(Zm,Yl,Rf),Yl=matchMedia(`(min-resolution: ${Ee-.001}dppx) and (max-resolution: ${Ee+.001}dppx)`),ur(Zm,Yl,Rf),co.dispatchEvent(new CustomEvent(Kl)))}function Zn(i,t){if(t!=null){let e=i.classList;!e.contains(t)&&e.add(t)}}function Pf(i,t){let e=i.classList;e.contains(t)&&e.remove(t)}function Ge(i,t,e){i.style[t]=e+"px"}function Ti(i,t,e,n){let s=Cf.createElement(i);return t!=null&&Zn(s,t),e?.insertBefore(s,n),s}function hi(i,t){return Ti("div",i,t)}var Jm=new WeakMap;function Wi(i,t,e,n,s){let r="translate("+t+"px,"+e+"px)",o=Jm.get(i);r!=o&&(i.style.transform=r,Jm.set(i,r),t<0||e<0||t>n||e>s?Zn(i,hr):Pf(i,hr))}var Km=new WeakMap;function jm(i,t,e){let n=t+e,s=Km.get(i);n!=s&&(Km.set(i,n),i.style.background=t,i.style.borderColor=e)}var Qm=new WeakMap;function tg(i,t,e,n){let s=t+""+e,r=Qm.get(i);s!=r&&(Qm.set(i,s),i.style.height=e+"px",i.style.width=t+"px",i.style.marginLeft=n?-t/2+"px":0,i.style.marginTop=n?-e/2+"px":0)}var kf={passive:!0},Zw={...kf,capture:!0};function ur(i,t,e,n){t.addEventListener(i,e,n?Zw:kf)}function If(i,t,e,n){t.removeEventListener(i,e,kf)}go&&Rf();function Ai(i,t,e,n){let s;e=e||0,n=n||t.length-1;let r=n<=2147483647;for(;n-e>1;)s=r?e+n>>1:Jn((e+n)/2),t[s]<i?e=s:n=s;return i-t[e]<=t[n]-i?e:n}function ho(i,t,e,n){for(let s=n==1?t:e;s>=t&&s<=e;s+=n)if(i[s]!=null)return s;return-1}function Jw(i,t,e,n){let s=ge,r=-ge;if(n==1)s=i[t],r=i[e];else if(n==-1)s=i[e],r=i[t];else for(let o=t;o<=e;o++){let a=i[o];a!=null&&(a<s&&(s=a),a>r&&(r=a))}return[s,r]}function Kw(i,t,e){let n=ge,s=-ge;for(let r=t;r<=e;r++){let o=i[r];o!=null&&o>0&&(o<n&&(n=o),o>s&&(s=o))}return[n,s]}function tc(i,t,e,n){let s=ig(i),r=ig(t);i==t&&(s==-1?(i*=e,t/=e):(i/=e,t*=e));let o=e==10?ds:Cg,a=s==1?Jn:ui,l=r==1?ui:Jn,c=a(o(ln(i))),h=l(o(ln(t))),f=uo(e,c),u=uo(e,h);return e==10&&(c<0&&(f=Oe(f,-c)),h<0&&(u=Oe(u,-h))),n||e==2?(i=f*s,t=u*r):(i=Ig(i,f),t=ec(t,u)),[i,t]}function Vf(i,t,e,n){let s=tc(i,t,e,n);return i==0&&(s[0]=0),t==0&&(s[1]=0),s}var Hf=.1,eg={mode:3,pad:Hf},ea={pad:0,soft:null,mode:0},jw={min:ea,max:ea};function jl(i,t,e,n){return nc(e)?ng(i,t,e):(ea.pad=e,ea.soft=n?0:null,ea.mode=n?3:0,ng(i,t,jw))}function Se(i,t){return i??t}function Qw(i,t,e){for(t=Se(t,0),e=Se(e,i.length-1);t<=e;){if(i[t]!=null)return!0;t++}return!1}function ng(i,t,e){let n=e.min,s=e.max,r=Se(n.pad,0),o=Se(s.pad,0),a=Se(n.hard,-ge),l=Se(s.hard,ge),c=Se(n.soft,ge),h=Se(s.soft,-ge),f=Se(n.mode,0),u=Se(s.mode,0),d=t-i,m=ds(d),_=Tn(ln(i),ln(t)),g=ds(_),p=ln(g-m);(d<1e-24||p>10)&&(d=0,(i==0||t==0)&&(d=1e-24,f==2&&c!=ge&&(r=0),u==2&&h!=-ge&&(o=0)));let S=d||_||1e3,v=ds(S),y=uo(10,Jn(v)),U=S*(d==0?i==0?.1:1:r),R=Oe(Ig(i-U,y/10),24),P=i>=c&&(f==1||f==3&&R<=c||f==2&&R>=c)?c:ge,F=Tn(a,R<P&&i>=P?P:fi(P,R)),E=S*(d==0?t==0?.1:1:o),M=Oe(ec(t+E,y/10),24),A=t<=h&&(u==1||u==3&&M>=h||u==2&&M<=h)?h:-ge,W=fi(l,M>A&&t<=A?A:Tn(A,M));return F==W&&F==0&&(W=100),[F,W]}var t1=new Intl.NumberFormat(go?$w.language:"en-US"),Gf=i=>t1.format(i),Kn=Math,Jl=Kn.PI,ln=Kn.abs,Jn=Kn.floor,an=Kn.round,ui=Kn.ceil,fi=Kn.min,Tn=Kn.max,uo=Kn.pow,ig=Kn.sign,ds=Kn.log10,Cg=Kn.log2,e1=(i,t=1)=>Kn.sinh(i)*t,wf=(i,t=1)=>Kn.asinh(i/t),ge=1/0;function sg(i){return(ds((i^i>>31)-(i>>31))|0)+1}function Lf(i,t,e){return fi(Tn(i,t),e)}function me(i){return typeof i=="function"?i:()=>i}var n1=()=>{},Rg=i=>i,Pg=(i,t)=>t,i1=i=>null,rg=i=>!0,og=(i,t)=>i==t,s1=/\.\d*?(?=9{6,}|0{6,})/gm,fr=i=>{if(Dg(i)||Fs.has(i))return i;let t=`${i}`,e=t.match(s1);if(e==null)return i;let n=e[0].length-1;if(t.indexOf("e-")!=-1){let[s,r]=t.split("e");return+`${fr(s)}e${r}`}return Oe(i,n)};function lr(i,t){return fr(Oe(fr(i/t))*t)}function ec(i,t){return fr(ui(fr(i/t))*t)}function Ig(i,t){return fr(Jn(fr(i/t))*t)}function Oe(i,t=0){if(Dg(i))return i;let e=10**t,n=i*e*(1+Number.EPSILON);return an(n)/e}var Fs=new Map;function Lg(i){return((""+i).split(".")[1]||"").length}function ia(i,t,e,n){let s=[],r=n.map(Lg);for(let o=t;o<e;o++){let a=ln(o),l=Oe(uo(i,o),a);for(let c=0;c<n.length;c++){let h=i==10?+`${n[c]}e${o}`:n[c]*l,f=(o>=0?0:a)+(o>=r[c]?0:r[c]),u=i==10?h:Oe(h,f);s.push(u),Fs.set(u,f)}}return s}var na={},Wf=[],fo=[null,null],Ns=Array.isArray,Dg=Number.isInteger,r1=i=>i===void 0;function ag(i){return typeof i=="string"}function nc(i){let t=!1;if(i!=null){let e=i.constructor;t=e==null||e==Object}return t}function o1(i){return i!=null&&typeof i=="object"}var a1=Object.getPrototypeOf(Uint8Array),Ug="__proto__";function po(i,t=nc){let e;if(Ns(i)){let n=i.find(s=>s!=null);if(Ns(n)||t(n)){e=Array(i.length);for(let s=0;s<i.length;s++)e[s]=po(i[s],t)}else e=i.slice()}else if(i instanceof a1)e=i.slice();else if(t(i)){e={};for(let n in i)n!=Ug&&(e[n]=po(i[n],t))}else e=i;return e}function en(i){let t=arguments;for(let e=1;e<t.length;e++){let n=t[e];for(let s in n)s!=Ug&&(nc(i[s])?en(i[s],po(n[s])):i[s]=po(n[s]))}return i}var l1=0,c1=1,h1=2;function u1(i,t,e){for(let n=0,s,r=-1;n<t.length;n++){let o=t[n];if(o>r){for(s=o-1;s>=0&&i[s]==null;)i[s--]=null;for(s=o+1;s<e&&i[s]==null;)i[r=s++]=null}}}function f1(i,t){if(m1(i)){let o=i[0].slice();for(let a=1;a<i.length;a++)o.push(...i[a].slice(1));return g1(o[0])||(o=p1(o)),o}let e=new Set;for(let o=0;o<i.length;o++){let l=i[o][0],c=l.length;for(let h=0;h<c;h++)e.add(l[h])}let n=[Array.from(e).sort((o,a)=>o-a)],s=n[0].length,r=new Map;for(let o=0;o<s;o++)r.set(n[0][o],o);for(let o=0;o<i.length;o++){let a=i[o],l=a[0];for(let c=1;c<a.length;c++){let h=a[c],f=Array(s).fill(void 0),u=t?t[o][c]:c1,d=[];for(let m=0;m<h.length;m++){let _=h[m],g=r.get(l[m]);_===null?u!=l1&&(f[g]=_,u==h1&&d.push(g)):f[g]=_}u1(f,d,s),n.push(f)}}return n}var d1=typeof queueMicrotask>"u"?i=>Promise.resolve().then(i):queueMicrotask;function p1(i){let t=i[0],e=t.length,n=Array(e);for(let r=0;r<n.length;r++)n[r]=r;n.sort((r,o)=>t[r]-t[o]);let s=[];for(let r=0;r<i.length;r++){let o=i[r],a=Array(e);for(let l=0;l<e;l++)a[l]=o[n[l]];s.push(a)}return s}function m1(i){let t=i[0][0],e=t.length;for(let n=1;n<i.length;n++){let s=i[n][0];if(s.length!=e)return!1;if(s!=t){for(let r=0;r<e;r++)if(s[r]!=t[r])return!1}}return!0}function g1(i,t=100){let e=i.length;if(e<=1)return!0;let n=0,s=e-1;for(;n<=s&&i[n]==null;)n++;for(;s>=n&&i[s]==null;)s--;if(s<=n)return!0;let r=Tn(1,Jn((s-n+1)/t));for(let o=i[n],a=n+r;a<=s;a+=r){let l=i[a];if(l!=null){if(l<=o)return!1;o=l}}return!0}var Ng=["January","February","March","April","May","June","July","August","September","October","November","December"],Fg=["Sunday","Monday","Tuesday","Wednesday","Thursday","Friday","Saturday"];function Og(i){return i.slice(0,3)}var _1=Fg.map(Og),x1=Ng.map(Og),y1={MMMM:Ng,MMM:x1,WWWW:Fg,WWW:_1};function Ko(i){return(i<10?"0":"")+i}function v1(i){return(i<10?"00":i<100?"0":"")+i}var M1={YYYY:i=>i.getFullYear(),YY:i=>(i.getFullYear()+"").slice(2),MMMM:(i,t)=>t.MMMM[i.getMonth()],MMM:(i,t)=>t.MMM[i.getMonth()],MM:i=>Ko(i.getMonth()+1),M:i=>i.getMonth()+1,DD:i=>Ko(i.getDate()),D:i=>i.getDate(),WWWW:(i,t)=>t.WWWW[i.getDay()],WWW:(i,t)=>t.WWW[i.getDay()],HH:i=>Ko(i.getHours()),H:i=>i.getHours(),h:i=>{let t=i.getHours();return t==0?12:t>12?t-12:t},AA:i=>i.getHours()>=12?"PM":"AM",aa:i=>i.getHours()>=12?"pm":"am",a:i=>i.getHours()>=12?"p":"a",mm:i=>Ko(i.getMinutes()),m:i=>i.getMinutes(),ss:i=>Ko(i.getSeconds()),s:i=>i.getSeconds(),fff:i=>v1(i.getMilliseconds())};function Xf(i,t){t=t||y1;let e=[],n=/\{([a-z]+)\}|[^{]+/gi,s;for(;s=n.exec(i);)e.push(s[0][0]=="{"?M1[s[1]]:s[0]);return r=>{let o="";for(let a=0;a<e.length;a++)o+=typeof e[a]=="string"?e[a]:e[a](r,t);return o}}var b1=new Intl.DateTimeFormat().resolvedOptions().timeZone;function S1(i,t){let e;return t=="UTC"||t=="Etc/UTC"?e=new Date(+i+i.getTimezoneOffset()*6e4):t==b1?e=i:(e=new Date(i.toLocaleString("en-US",{timeZone:t})),e.setMilliseconds(i.getMilliseconds())),e}var Bg=i=>i%1==0,Ql=[1,2,2.5,5],w1=ia(10,-32,0,Ql),zg=ia(10,0,32,Ql),E1=zg.filter(Bg),cr=w1.concat(zg),qf=`
`,kg="{YYYY}",lg=qf+kg,Vg="{M}/{D}",ta=qf+Vg,$l=ta+"/{YY}",Hg="{aa}",T1="{h}:{mm}",lo=T1+Hg,cg=qf+lo,hg=":{ss}",Ae=null;function Gg(i){let t=i*1e3,e=t*60,n=e*60,s=n*24,r=s*30,o=s*365,l=(i==1?ia(10,0,3,Ql).filter(Bg):ia(10,-3,0,Ql)).concat([t,t*5,t*10,t*15,t*30,e,e*5,e*10,e*15,e*30,n,n*2,n*3,n*4,n*6,n*8,n*12,s,s*2,s*3,s*4,s*5,s*6,s*7,s*8,s*9,s*10,s*15,r,r*2,r*3,r*4,r*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,kg,Ae,Ae,Ae,Ae,Ae,Ae,1],[s*28,"{MMM}",lg,Ae,Ae,Ae,Ae,Ae,1],[s,Vg,lg,Ae,Ae,Ae,Ae,Ae,1],[n,"{h}"+Hg,$l,Ae,ta,Ae,Ae,Ae,1],[e,lo,$l,Ae,ta,Ae,Ae,Ae,1],[t,hg,$l+" "+lo,Ae,ta+" "+lo,Ae,cg,Ae,1],[i,hg+".{fff}",$l+" "+lo,Ae,ta+" "+lo,Ae,cg,Ae,1]];function h(f){return(u,d,m,_,g,p)=>{let S=[],v=g>=o,y=g>=r&&g<o,U=f(m),R=Oe(U*i,3),P=Ef(U.getFullYear(),v?0:U.getMonth(),y||v?1:U.getDate()),F=Oe(P*i,3);if(y||v){let E=y?g/r:0,M=v?g/o:0,A=R==F?R:Oe(Ef(P.getFullYear()+M,P.getMonth()+E,1)*i,3),W=new Date(an(A/i)),G=W.getFullYear(),X=W.getMonth();for(let Z=0;A<=_;Z++){let Y=Ef(G+M*Z,X+E*Z,1),nt=Y-f(Oe(Y*i,3));A=Oe((+Y+nt)*i,3),A<=_&&S.push(A)}}else{let E=g>=s?s:g,M=Jn(m)-Jn(R),A=F+M+ec(R-F,E);S.push(A);let W=f(A),G=W.getHours()+W.getMinutes()/e+W.getSeconds()/n,X=g/n,Z=u.axes[d]._space,Y=p/Z;for(;A=Oe(A+g,i==1?0:3),!(A>_);)if(X>1){let nt=Jn(Oe(G+X,6))%24,at=f(A).getHours()-nt;at>1&&(at=-1),A-=at*n,G=(G+X)%24;let _t=S[S.length-1];Oe((A-_t)/g,3)*Y>=.7&&S.push(A)}else S.push(A)}return S}}return[l,c,h]}var[A1,C1,R1]=Gg(1),[P1,I1,L1]=Gg(.001);ia(2,-53,53,[1]);function ug(i,t){return i.map(e=>e.map((n,s)=>s==0||s==8||n==null?n:t(s==1||e[8]==0?n:e[1]+n)))}function fg(i,t){return(e,n,s,r,o)=>{let a=t.find(m=>o>=m[0])||t[t.length-1],l,c,h,f,u,d;return n.map(m=>{let _=i(m),g=_.getFullYear(),p=_.getMonth(),S=_.getDate(),v=_.getHours(),y=_.getMinutes(),U=_.getSeconds(),R=g!=l&&a[2]||p!=c&&a[3]||S!=h&&a[4]||v!=f&&a[5]||y!=u&&a[6]||U!=d&&a[7]||a[1];return l=g,c=p,h=S,f=v,u=y,d=U,R(_)})}}function D1(i,t){let e=Xf(t);return(n,s,r,o,a)=>s.map(l=>e(i(l)))}function Ef(i,t,e){return new Date(i,t,e)}function dg(i,t){return t(i)}var U1="{YYYY}-{MM}-{DD} {h}:{mm}{aa}";function pg(i,t){return(e,n,s,r)=>r==null?zf:t(i(n))}function N1(i,t){let e=i.series[t];return e.width?e.stroke(i,t):e.points.width?e.points.stroke(i,t):null}function F1(i,t){return i.series[t].fill(i,t)}var O1={show:!0,live:!0,isolate:!1,mount:n1,markers:{show:!0,width:2,stroke:N1,fill:F1,dash:"solid"},idx:null,idxs:null,values:[]};function B1(i,t){let e=i.cursor.points,n=hi(),s=e.size(i,t);Ge(n,jo,s),Ge(n,Qo,s);let r=s/-2;Ge(n,"marginLeft",r),Ge(n,"marginTop",r);let o=e.width(i,t,s);return o&&Ge(n,"borderWidth",o),n}function z1(i,t){let e=i.series[t].points;return e._fill||e._stroke}function k1(i,t){let e=i.series[t].points;return e._stroke||e._fill}function V1(i,t){return i.series[t].points.size}var Tf=[0,0];function H1(i,t,e){return Tf[0]=t,Tf[1]=e,Tf}function Zl(i,t,e,n=!0){return s=>{s.button==0&&(!n||s.target==t)&&e(s)}}function Af(i,t,e,n=!0){return s=>{(!n||s.target==t)&&e(s)}}var G1={show:!0,x:!0,y:!0,lock:!1,move:H1,points:{one:!1,show:B1,size:V1,width:0,stroke:k1,fill:z1},bind:{mousedown:Zl,mouseup:Zl,click:Zl,dblclick:Zl,mousemove:Af,mouseleave:Af,mouseenter:Af},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(i,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(i,t,e,n,s)=>n-s,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},Wg={show:!0,stroke:"rgba(0,0,0,0.07)",width:2},Yf=en({},Wg,{filter:Pg}),Xg=en({},Yf,{size:10}),qg=en({},Wg,{show:!1}),$f='12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"',Yg="bold "+$f,$g=1.5,mg={show:!0,scale:"x",stroke:Bf,space:50,gap:5,size:50,labelGap:0,labelSize:30,labelFont:Yg,side:2,grid:Yf,ticks:Xg,border:qg,font:$f,lineGap:$g,rotate:0},W1="Value",X1="Time",gg={show:!0,scale:"x",auto:!1,sorted:1,min:ge,max:-ge,idxs:[]};function q1(i,t,e,n,s){return t.map(r=>r==null?"":Gf(r))}function Y1(i,t,e,n,s,r,o){let a=[],l=Fs.get(s)||0;e=o?e:Oe(ec(e,s),l);for(let c=e;c<=n;c=Oe(c+s,l))a.push(Object.is(c,-0)?0:c);return a}function Df(i,t,e,n,s,r,o){let a=[],l=i.scales[i.axes[t].scale].log,c=l==10?ds:Cg,h=Jn(c(e));s=uo(l,h),l==10&&(s=cr[Ai(s,cr)]);let f=e,u=s*l;l==10&&(u=cr[Ai(u,cr)]);do a.push(f),f=f+s,l==10&&!Fs.has(f)&&(f=Oe(f,Fs.get(s))),f>=u&&(s=f,u=s*l,l==10&&(u=cr[Ai(u,cr)]));while(f<=n);return a}function $1(i,t,e,n,s,r,o){let l=i.scales[i.axes[t].scale].asinh,c=n>l?Df(i,t,Tn(l,e),n,s):[l],h=n>=0&&e<=0?[0]:[];return(e<-l?Df(i,t,Tn(l,-n),-e,s):[l]).reverse().map(u=>-u).concat(h,c)}var Zg=/./,Z1=/[12357]/,J1=/[125]/,_g=/1/,Uf=(i,t,e,n)=>i.map((s,r)=>t==4&&s==0||r%n==0&&e.test(s.toExponential()[s<0?1:0])?s:null);function K1(i,t,e,n,s){let r=i.axes[e],o=r.scale,a=i.scales[o],l=i.valToPos,c=r._space,h=l(10,o),f=l(9,o)-h>=c?Zg:l(7,o)-h>=c?Z1:l(5,o)-h>=c?J1:_g;if(f==_g){let u=ln(l(1,o)-h);if(u<c)return Uf(t.slice().reverse(),a.distr,f,ui(c/u)).reverse()}return Uf(t,a.distr,f,1)}function j1(i,t,e,n,s){let r=i.axes[e],o=r.scale,a=r._space,l=i.valToPos,c=ln(l(1,o)-l(2,o));return c<a?Uf(t.slice().reverse(),3,Zg,ui(a/c)).reverse():t}function Q1(i,t,e,n){return n==null?zf:t==null?"":Gf(t)}var xg={show:!0,scale:"y",stroke:Bf,space:30,gap:5,size:50,labelGap:0,labelSize:30,labelFont:Yg,side:3,grid:Yf,ticks:Xg,border:qg,font:$f,lineGap:$g,rotate:0};function tE(i,t){let e=3+(i||1)*2;return Oe(e*t,3)}function eE(i,t){let{scale:e,idxs:n}=i.series[0],s=i._data[0],r=i.valToPos(s[n[0]],e,!0),o=i.valToPos(s[n[1]],e,!0),a=ln(o-r),l=i.series[t],c=a/(l.points.space*Ee);return n[1]-n[0]<=c}var yg={scale:null,auto:!0,sorted:0,min:ge,max:-ge},Jg=(i,t,e,n,s)=>s,vg={show:!0,auto:!0,sorted:0,gaps:Jg,alpha:1,facets:[en({},yg,{scale:"x"}),en({},yg,{scale:"y"})]},Mg={scale:"y",auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:Jg,alpha:1,points:{show:eE,filter:null},values:null,min:ge,max:-ge,idxs:[],path:null,clip:null};function nE(i,t,e,n,s){return e/10}var Kg={time:!0,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},iE=en({},Kg,{time:!1,ori:1}),bg={};function jg(i,t){let e=bg[i];return e||(e={key:i,plots:[],sub(n){e.plots.push(n)},unsub(n){e.plots=e.plots.filter(s=>s!=n)},pub(n,s,r,o,a,l,c){for(let h=0;h<e.plots.length;h++)e.plots[h]!=s&&e.plots[h].pub(n,s,r,o,a,l,c)}},i!=null&&(bg[i]=e)),e}var mo=1,Nf=2;function dr(i,t,e){let n=i.mode,s=i.series[t],r=n==2?i._data[t]:i._data,o=i.scales,a=i.bbox,l=r[0],c=n==2?r[1]:r[t],h=n==2?o[s.facets[0].scale]:o[i.series[0].scale],f=n==2?o[s.facets[1].scale]:o[s.scale],u=a.left,d=a.top,m=a.width,_=a.height,g=i.valToPosH,p=i.valToPosV;return h.ori==0?e(s,l,c,h,f,g,p,u,d,m,_,sc,_o,oc,t0,n0):e(s,l,c,h,f,p,g,d,u,_,m,rc,xo,Kf,e0,i0)}function Zf(i,t){let e=0,n=0,s=Se(i.bands,Wf);for(let r=0;r<s.length;r++){let o=s[r];o.series[0]==t?e=o.dir:o.series[1]==t&&(o.dir==1?n|=1:n|=2)}return[e,n==1?-1:n==2?1:n==3?2:0]}function sE(i,t,e,n,s){let r=i.mode,o=i.series[t],a=r==2?o.facets[1].scale:o.scale,l=i.scales[a];return s==-1?l.min:s==1?l.max:l.distr==3?l.dir==1?l.min:l.max:0}function ps(i,t,e,n,s,r){return dr(i,t,(o,a,l,c,h,f,u,d,m,_,g)=>{let p=o.pxRound,S=c.dir*(c.ori==0?1:-1),v=c.ori==0?_o:xo,y,U;S==1?(y=e,U=n):(y=n,U=e);let R=p(f(a[y],c,_,d)),P=p(u(l[y],h,g,m)),F=p(f(a[U],c,_,d)),E=p(u(r==1?h.max:h.min,h,g,m)),M=new Path2D(s);return v(M,F,E),v(M,R,E),v(M,R,P),M})}function ic(i,t,e,n,s,r){let o=null;if(i.length>0){o=new Path2D;let a=t==0?oc:Kf,l=e;for(let f=0;f<i.length;f++){let u=i[f];if(u[1]>u[0]){let d=u[0]-l;d>0&&a(o,l,n,d,n+r),l=u[1]}}let c=e+s-l,h=10;c>0&&a(o,l,n-h/2,c,n+r+h)}return o}function rE(i,t,e){let n=i[i.length-1];n&&n[0]==t?n[1]=e:i.push([t,e])}function Jf(i,t,e,n,s,r,o){let a=[],l=i.length;for(let c=s==1?e:n;c>=e&&c<=n;c+=s)if(t[c]===null){let f=c,u=c;if(s==1)for(;++c<=n&&t[c]===null;)u=c;else for(;--c>=e&&t[c]===null;)u=c;let d=r(i[f]),m=u==f?d:r(i[u]),_=f-s;d=o<=0&&_>=0&&_<l?r(i[_]):d;let p=u+s;m=o>=0&&p>=0&&p<l?r(i[p]):m,m>=d&&a.push([d,m])}return a}function Sg(i){return i==0?Rg:i==1?an:t=>lr(t,i)}function Qg(i){let t=i==0?sc:rc,e=i==0?(s,r,o,a,l,c)=>{s.arcTo(r,o,a,l,c)}:(s,r,o,a,l,c)=>{s.arcTo(o,r,l,a,c)},n=i==0?(s,r,o,a,l)=>{s.rect(r,o,a,l)}:(s,r,o,a,l)=>{s.rect(o,r,l,a)};return(s,r,o,a,l,c=0,h=0)=>{c==0&&h==0?n(s,r,o,a,l):(c=fi(c,a/2,l/2),h=fi(h,a/2,l/2),t(s,r+c,o),e(s,r+a,o,r+a,o+l,c),e(s,r+a,o+l,r,o+l,h),e(s,r,o+l,r,o,h),e(s,r,o,r+a,o,c),s.closePath())}}var sc=(i,t,e)=>{i.moveTo(t,e)},rc=(i,t,e)=>{i.moveTo(e,t)},_o=(i,t,e)=>{i.lineTo(t,e)},xo=(i,t,e)=>{i.lineTo(e,t)},oc=Qg(0),Kf=Qg(1),t0=(i,t,e,n,s,r)=>{i.arc(t,e,n,s,r)},e0=(i,t,e,n,s,r)=>{i.arc(e,t,n,s,r)},n0=(i,t,e,n,s,r,o)=>{i.bezierCurveTo(t,e,n,s,r,o)},i0=(i,t,e,n,s,r,o)=>{i.bezierCurveTo(e,t,s,n,o,r)};function s0(i){return(t,e,n,s,r)=>dr(t,e,(o,a,l,c,h,f,u,d,m,_,g)=>{let{pxRound:p,points:S}=o,v,y;c.ori==0?(v=sc,y=t0):(v=rc,y=e0);let U=Oe(S.width*Ee,3),R=(S.size-S.width)/2*Ee,P=Oe(R*2,3),F=new Path2D,E=new Path2D,{left:M,top:A,width:W,height:G}=t.bbox;oc(E,M-P,A-P,W+P*2,G+P*2);let X=Z=>{if(l[Z]!=null){let Y=p(f(a[Z],c,_,d)),nt=p(u(l[Z],h,g,m));v(F,Y+R,nt),y(F,Y,nt,R,0,Jl*2)}};if(r)r.forEach(X);else for(let Z=n;Z<=s;Z++)X(Z);return{stroke:U>0?F:null,fill:F,clip:E,flags:mo|Nf}})}function r0(i){return(t,e,n,s,r,o)=>{n!=s&&(r!=n&&o!=n&&i(t,e,n),r!=s&&o!=s&&i(t,e,s),i(t,e,o))}}var oE=r0(_o),aE=r0(xo);function o0(i){let t=Se(i?.alignGaps,0);return(e,n,s,r)=>dr(e,n,(o,a,l,c,h,f,u,d,m,_,g)=>{let p=o.pxRound,S=pt=>p(f(pt,c,_,d)),v=pt=>p(u(pt,h,g,m)),y,U;c.ori==0?(y=_o,U=oE):(y=xo,U=aE);let R=c.dir*(c.ori==0?1:-1),P={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:mo},F=P.stroke,E=ge,M=-ge,A,W,G,X=S(a[R==1?s:r]),Z=ho(l,s,r,1*R),Y=ho(l,s,r,-1*R),nt=S(a[Z]),Q=S(a[Y]),dt=!1;for(let pt=R==1?s:r;pt>=s&&pt<=r;pt+=R){let Zt=S(a[pt]),J=l[pt];Zt==X?J!=null?(W=v(J),E==ge&&(y(F,Zt,W),A=W),E=fi(W,E),M=Tn(W,M)):J===null&&(dt=!0):(E!=ge&&(U(F,X,E,M,A,W),G=X),J!=null?(W=v(J),y(F,Zt,W),E=M=A=W):(E=ge,M=-ge,J===null&&(dt=!0)),X=Zt)}E!=ge&&E!=M&&G!=X&&U(F,X,E,M,A,W);let[at,_t]=Zf(e,n);if(o.fill!=null||at!=0){let pt=P.fill=new Path2D(F),Zt=o.fillTo(e,n,o.min,o.max,at),J=v(Zt);y(pt,Q,J),y(pt,nt,J)}if(!o.spanGaps){let pt=[];dt&&pt.push(...Jf(a,l,s,r,R,S,t)),P.gaps=pt=o.gaps(e,n,s,r,pt),P.clip=ic(pt,c.ori,d,m,_,g)}return _t!=0&&(P.band=_t==2?[ps(e,n,s,r,F,-1),ps(e,n,s,r,F,1)]:ps(e,n,s,r,F,_t)),P})}function lE(i){let t=Se(i.align,1),e=Se(i.ascDesc,!1),n=Se(i.alignGaps,0),s=Se(i.extend,!1);return(r,o,a,l)=>dr(r,o,(c,h,f,u,d,m,_,g,p,S,v)=>{let y=c.pxRound,{left:U,width:R}=r.bbox,P=at=>y(m(at,u,S,g)),F=at=>y(_(at,d,v,p)),E=u.ori==0?_o:xo,M={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:mo},A=M.stroke,W=u.dir*(u.ori==0?1:-1);a=ho(f,a,l,1),l=ho(f,a,l,-1);let G=F(f[W==1?a:l]),X=P(h[W==1?a:l]),Z=X,Y=X;s&&t==-1&&(Y=U,E(A,Y,G)),E(A,X,G);for(let at=W==1?a:l;at>=a&&at<=l;at+=W){let _t=f[at];if(_t==null)continue;let pt=P(h[at]),Zt=F(_t);t==1?E(A,pt,G):E(A,Z,Zt),E(A,pt,Zt),G=Zt,Z=pt}let nt=Z;s&&t==1&&(nt=U+R,E(A,nt,G));let[Q,dt]=Zf(r,o);if(c.fill!=null||Q!=0){let at=M.fill=new Path2D(A),_t=c.fillTo(r,o,c.min,c.max,Q),pt=F(_t);E(at,nt,pt),E(at,Y,pt)}if(!c.spanGaps){let at=[];at.push(...Jf(h,f,a,l,W,P,n));let _t=c.width*Ee/2,pt=e||t==1?_t:-_t,Zt=e||t==-1?-_t:_t;at.forEach(J=>{J[0]+=pt,J[1]+=Zt}),M.gaps=at=c.gaps(r,o,a,l,at),M.clip=ic(at,u.ori,g,p,S,v)}return dt!=0&&(M.band=dt==2?[ps(r,o,a,l,A,-1),ps(r,o,a,l,A,1)]:ps(r,o,a,l,A,dt)),M})}function wg(i,t,e,n,s,r,o=ge){if(i.length>1){let a=null;for(let l=0,c=1/0;l<i.length;l++)if(t[l]!==void 0){if(a!=null){let h=ln(i[l]-i[a]);h<c&&(c=h,o=ln(e(i[l],n,s,r)-e(i[a],n,s,r)))}a=l}}return o}function cE(i){i=i||na;let t=Se(i.size,[.6,ge,1]),e=i.align||0,n=i.gap||0,s=i.radius;s=s==null?[0,0]:typeof s=="number"?[s,0]:s;let r=me(s),o=1-t[0],a=Se(t[1],ge),l=Se(t[2],1),c=Se(i.disp,na),h=Se(i.each,d=>{}),{fill:f,stroke:u}=c;return(d,m,_,g)=>dr(d,m,(p,S,v,y,U,R,P,F,E,M,A)=>{let W=p.pxRound,G=e,X=n*Ee,Z=a*Ee,Y=l*Ee,nt,Q;y.ori==0?[nt,Q]=r(d,m):[Q,nt]=r(d,m);let dt=y.dir*(y.ori==0?1:-1),at=y.ori==0?oc:Kf,_t=y.ori==0?h:(j,et,Nt,Mt,At,Kt,ct)=>{h(j,et,Nt,At,Mt,ct,Kt)},pt=Se(d.bands,Wf).find(j=>j.series[0]==m),Zt=pt!=null?pt.dir:0,J=p.fillTo(d,m,p.min,p.max,Zt),ht=W(P(J,U,A,E)),Ot,lt,Ft,Yt=M,Ut=W(p.width*Ee),te=!1,st=null,mt=null,N=null,Vt=null;f!=null&&(Ut==0||u!=null)&&(te=!0,st=f.values(d,m,_,g),mt=new Map,new Set(st).forEach(j=>{j!=null&&mt.set(j,new Path2D)}),Ut>0&&(N=u.values(d,m,_,g),Vt=new Map,new Set(N).forEach(j=>{j!=null&&Vt.set(j,new Path2D)})));let{x0:ut,size:Tt}=c;if(ut!=null&&Tt!=null){G=1,S=ut.values(d,m,_,g),ut.unit==2&&(S=S.map(Nt=>d.posToVal(F+Nt*M,y.key,!0)));let j=Tt.values(d,m,_,g);Tt.unit==2?lt=j[0]*M:lt=R(j[0],y,M,F)-R(0,y,M,F),Yt=wg(S,v,R,y,M,F,Yt),Ft=Yt-lt+X}else Yt=wg(S,v,R,y,M,F,Yt),Ft=Yt*o+X,lt=Yt-Ft;Ft<1&&(Ft=0),Ut>=lt/2&&(Ut=0),Ft<5&&(W=Rg);let xt=Ft>0,Jt=Yt-Ft-(xt?Ut:0);lt=W(Lf(Jt,Y,Z)),Ot=(G==0?lt/2:G==dt?0:lt)-G*dt*((G==0?X/2:0)+(xt?Ut/2:0));let St={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},C=te?null:new Path2D,b=null;if(pt!=null)b=d.data[pt.series[1]];else{let{y0:j,y1:et}=c;j!=null&&et!=null&&(v=et.values(d,m,_,g),b=j.values(d,m,_,g))}let B=nt*lt,tt=Q*lt;for(let j=dt==1?_:g;j>=_&&j<=g;j+=dt){let et=v[j];if(et==null)continue;if(b!=null){let $t=b[j]??0;if(et-$t==0)continue;ht=P($t,U,A,E)}let Nt=y.distr!=2||c!=null?S[j]:j,Mt=R(Nt,y,M,F),At=P(Se(et,J),U,A,E),Kt=W(Mt-Ot),ct=W(Tn(At,ht)),wt=W(fi(At,ht)),Xt=ct-wt;if(et!=null){let $t=et<0?tt:B,Rt=et<0?B:tt;te?(Ut>0&&N[j]!=null&&at(Vt.get(N[j]),Kt,wt+Jn(Ut/2),lt,Tn(0,Xt-Ut),$t,Rt),st[j]!=null&&at(mt.get(st[j]),Kt,wt+Jn(Ut/2),lt,Tn(0,Xt-Ut),$t,Rt)):at(C,Kt,wt+Jn(Ut/2),lt,Tn(0,Xt-Ut),$t,Rt),_t(d,m,j,Kt-Ut/2,wt,lt+Ut,Xt)}}return Ut>0?St.stroke=te?Vt:C:te||(St._fill=p.width==0?p._fill:p._stroke??p._fill,St.width=0),St.fill=te?mt:C,St})}function hE(i,t){let e=Se(t?.alignGaps,0);return(n,s,r,o)=>dr(n,s,(a,l,c,h,f,u,d,m,_,g,p)=>{let S=a.pxRound,v=nt=>S(u(nt,h,g,m)),y=nt=>S(d(nt,f,p,_)),U,R,P;h.ori==0?(U=sc,P=_o,R=n0):(U=rc,P=xo,R=i0);let F=h.dir*(h.ori==0?1:-1);r=ho(c,r,o,1),o=ho(c,r,o,-1);let E=v(l[F==1?r:o]),M=E,A=[],W=[];for(let nt=F==1?r:o;nt>=r&&nt<=o;nt+=F)if(c[nt]!=null){let dt=l[nt],at=v(dt);A.push(M=at),W.push(y(c[nt]))}let G={stroke:i(A,W,U,P,R,S),fill:null,clip:null,band:null,gaps:null,flags:mo},X=G.stroke,[Z,Y]=Zf(n,s);if(a.fill!=null||Z!=0){let nt=G.fill=new Path2D(X),Q=a.fillTo(n,s,a.min,a.max,Z),dt=y(Q);P(nt,M,dt),P(nt,E,dt)}if(!a.spanGaps){let nt=[];nt.push(...Jf(l,c,r,o,F,v,e)),G.gaps=nt=a.gaps(n,s,r,o,nt),G.clip=ic(nt,h.ori,m,_,g,p)}return Y!=0&&(G.band=Y==2?[ps(n,s,r,o,X,-1),ps(n,s,r,o,X,1)]:ps(n,s,r,o,X,Y)),G})}function uE(i){return hE(fE,i)}function fE(i,t,e,n,s,r){let o=i.length;if(o<2)return null;let a=new Path2D;if(e(a,i[0],t[0]),o==2)n(a,i[1],t[1]);else{let l=Array(o),c=Array(o-1),h=Array(o-1),f=Array(o-1);for(let u=0;u<o-1;u++)h[u]=t[u+1]-t[u],f[u]=i[u+1]-i[u],c[u]=h[u]/f[u];l[0]=c[0];for(let u=1;u<o-1;u++)c[u]===0||c[u-1]===0||c[u-1]>0!=c[u]>0?l[u]=0:(l[u]=3*(f[u-1]+f[u])/((2*f[u]+f[u-1])/c[u-1]+(f[u]+2*f[u-1])/c[u]),isFinite(l[u])||(l[u]=0));l[o-1]=c[o-2];for(let u=0;u<o-1;u++)s(a,i[u]+f[u]/3,t[u]+l[u]*f[u]/3,i[u+1]-f[u]/3,t[u+1]-l[u+1]*f[u]/3,i[u+1],t[u+1])}return a}var Ff=new Set;function Eg(){for(let i of Ff)i.syncRect(!0)}go&&(ur(qw,co,Eg),ur(Yw,co,Eg,!0),ur(Kl,co,()=>{xn.pxRatio=Ee}));var dE=o0(),pE=s0();function Tg(i,t,e,n){return(n?[i[0],i[1]].concat(i.slice(2)):[i[0]].concat(i.slice(1))).map((r,o)=>Of(r,o,t,e))}function mE(i,t){return i.map((e,n)=>n==0?{}:en({},t,e))}function Of(i,t,e,n){return en({},t==0?e:n,i)}function a0(i,t,e){return t==null?fo:[t,e]}var gE=a0;function _E(i,t,e){return t==null?fo:jl(t,e,Hf,!0)}function l0(i,t,e,n){return t==null?fo:tc(t,e,i.scales[n].log,!1)}var xE=l0;function c0(i,t,e,n){return t==null?fo:Vf(t,e,i.scales[n].log,!1)}var yE=c0;function vE(i,t,e,n,s){let r=Tn(sg(i),sg(t)),o=t-i,a=Ai(s/n*o,e);do{let l=e[a],c=n*l/o;if(c>=s&&r+(l<5?Fs.get(l):0)<=17)return[l,c]}while(++a<e.length);return[0,0]}function Ag(i){let t,e;return i=i.replace(/(\d+)px/,(n,s)=>(t=an((e=+s)*Ee))+"px"),[i,t,e]}function ME(i){i.show&&[i.font,i.labelFont].forEach(t=>{let e=Oe(t[2]*Ee,1);t[0]=t[0].replace(/[0-9.]+px/,e+"px"),t[1]=e})}function xn(i,t,e){let n={mode:Se(i.mode,1)},s=n.mode;function r(x,w){return((w.distr==3?ds(x>0?x:w.clamp(n,x,w.min,w.max,w.key)):w.distr==4?wf(x,w.asinh):w.distr==100?w.fwd(x):x)-w._min)/(w._max-w._min)}function o(x,w,I,L){let V=r(x,w);return L+I*(w.dir==-1?1-V:V)}function a(x,w,I,L){let V=r(x,w);return L+I*(w.dir==-1?V:1-V)}function l(x,w,I,L){return w.ori==0?o(x,w,I,L):a(x,w,I,L)}n.valToPosH=o,n.valToPosV=a;let c=!1;n.status=0;let h=n.root=hi(Cw);if(i.id!=null&&(h.id=i.id),Zn(h,i.class),i.title){let x=hi(Iw,h);x.textContent=i.title}let f=Ti("canvas"),u=n.ctx=f.getContext("2d"),d=hi(Lw,h);ur("click",d,x=>{x.target===_&&(ke!=Mr||Xe!=br)&&_n.click(n,x)},!0);let m=n.under=hi(Dw,d);d.appendChild(f);let _=n.over=hi(Uw,d);i=po(i);let g=+Se(i.pxAlign,1),p=Sg(g);(i.plugins||[]).forEach(x=>{x.opts&&(i=x.opts(n,i)||i)});let S=i.ms||.001,v=n.series=s==1?Tg(i.series||[],gg,Mg,!1):mE(i.series||[null],vg),y=n.axes=Tg(i.axes||[],mg,xg,!0),U=n.scales={},R=n.bands=i.bands||[];R.forEach(x=>{x.fill=me(x.fill||null),x.dir=Se(x.dir,-1)});let P=s==2?v[1].facets[0].scale:v[0].scale,F={axes:r_,series:Ne},E=(i.drawOrder||["axes","series"]).map(x=>F[x]);function M(x){let w=U[x];if(w==null){let I=(i.scales||na)[x]||na;if(I.from!=null)M(I.from),U[x]=en({},U[I.from],I,{key:x});else{w=U[x]=en({},x==P?Kg:iE,I),w.key=x;let L=w.time,V=w.range,$=Ns(V);if((x!=P||s==2&&!L)&&($&&(V[0]==null||V[1]==null)&&(V={min:V[0]==null?eg:{mode:1,hard:V[0],soft:V[0]},max:V[1]==null?eg:{mode:1,hard:V[1],soft:V[1]}},$=!1),!$&&nc(V))){let rt=V;V=(ft,vt,Lt)=>vt==null?fo:jl(vt,Lt,rt)}w.range=me(V||(L?gE:x==P?w.distr==3?xE:w.distr==4?yE:a0:w.distr==3?l0:w.distr==4?c0:_E)),w.auto=me($?!1:w.auto),w.clamp=me(w.clamp||nE),w._min=w._max=null}}}M("x"),M("y"),s==1&&v.forEach(x=>{M(x.scale)}),y.forEach(x=>{M(x.scale)});for(let x in i.scales)M(x);let A=U[P],W=A.distr,G,X;A.ori==0?(Zn(h,Rw),G=o,X=a):(Zn(h,Pw),G=a,X=o);let Z={};for(let x in U){let w=U[x];(w.min!=null||w.max!=null)&&(Z[x]={min:w.min,max:w.max},w.min=w.max=null)}let Y=i.tzDate||(x=>new Date(an(x/S))),nt=i.fmtDate||Xf,Q=S==1?R1(Y):L1(Y),dt=fg(Y,ug(S==1?C1:I1,nt)),at=pg(Y,dg(U1,nt)),_t=[],pt=n.legend=en({},O1,i.legend),Zt=pt.show,J=pt.markers;pt.idxs=_t,J.width=me(J.width),J.dash=me(J.dash),J.stroke=me(J.stroke),J.fill=me(J.fill);let ht,Ot,lt,Ft=[],Yt=[],Ut,te=!1,st={};if(pt.live){let x=v[1]?v[1].values:null;te=x!=null,Ut=te?x(n,1,0):{_:0};for(let w in Ut)st[w]=zf}if(Zt)if(ht=Ti("table",kw,h),lt=Ti("tbody",null,ht),pt.mount(n,ht),te){Ot=Ti("thead",null,ht,lt);let x=Ti("tr",null,Ot);Ti("th",null,x);for(var mt in Ut)Ti("th",Vm,x).textContent=mt}else Zn(ht,Hw),pt.live&&Zn(ht,Vw);let N={show:!0},Vt={show:!1};function ut(x,w){if(w==0&&(te||!pt.live||s==2))return fo;let I=[],L=Ti("tr",Gw,lt,lt.childNodes[w]);Zn(L,x.class),x.show||Zn(L,hr);let V=Ti("th",null,L);if(J.show){let ft=hi(Ww,V);if(w>0){let vt=J.width(n,w);vt&&(ft.style.border=vt+"px "+J.dash(n,w)+" "+J.stroke(n,w)),ft.style.background=J.fill(n,w)}}let $=hi(Vm,V);$.textContent=x.label,w>0&&(J.show||($.style.color=x.width>0?J.stroke(n,w):J.fill(n,w)),xt("click",V,ft=>{if(Bt._lock)return;fe(ft);let vt=v.indexOf(x);if((ft.ctrlKey||ft.metaKey)!=pt.isolate){let Lt=v.some((Dt,kt)=>kt>0&&kt!=vt&&Dt.show);v.forEach((Dt,kt)=>{kt>0&&Di(kt,Lt?kt==vt?N:Vt:N,!0,je.setSeries)})}else Di(vt,{show:!x.show},!0,je.setSeries)},!1),$i&&xt(qm,V,ft=>{Bt._lock||(fe(ft),Di(v.indexOf(x),wr,!0,je.setSeries))},!1));for(var rt in Ut){let ft=Ti("td",Xw,L);ft.textContent="--",I.push(ft)}return[L,I]}let Tt=new Map;function xt(x,w,I,L=!0){let V=Tt.get(w)||{},$=Bt.bind[x](n,w,I,L);$&&(ur(x,w,V[x]=$),Tt.set(w,V))}function Jt(x,w,I){let L=Tt.get(w)||{};for(let V in L)(x==null||V==x)&&(If(V,w,L[V]),delete L[V]);x==null&&Tt.delete(w)}let St=0,C=0,b=0,B=0,tt=0,j=0,et=tt,Nt=j,Mt=b,At=B,Kt=0,ct=0,wt=0,Xt=0;n.bbox={};let $t=!1,Rt=!1,ae=!1,ee=!1,we=!1,z=!1;function Et(x,w,I){(I||x!=n.width||w!=n.height)&&it(x,w),_r(!1),ae=!0,Rt=!0,xr()}function it(x,w){n.width=St=b=x,n.height=C=B=w,tt=j=0,se(),We();let I=n.bbox;Kt=I.left=lr(tt*Ee,.5),ct=I.top=lr(j*Ee,.5),wt=I.width=lr(b*Ee,.5),Xt=I.height=lr(B*Ee,.5)}let ot=3;function It(){let x=!1,w=0;for(;!x;){w++;let I=i_(w),L=s_(w);x=w==ot||I&&L,x||(it(n.width,n.height),Rt=!0)}}function Pt({width:x,height:w}){Et(x,w)}n.setSize=Pt;function se(){let x=!1,w=!1,I=!1,L=!1;y.forEach((V,$)=>{if(V.show&&V._show){let{side:rt,_size:ft}=V,vt=rt%2,Lt=V.label!=null?V.labelSize:0,Dt=ft+Lt;Dt>0&&(vt?(b-=Dt,rt==3?(tt+=Dt,L=!0):I=!0):(B-=Dt,rt==0?(j+=Dt,x=!0):w=!0))}}),Ii[0]=x,Ii[1]=I,Ii[2]=w,Ii[3]=L,b-=Li[1]+Li[3],tt+=Li[3],B-=Li[2]+Li[0],j+=Li[0]}function We(){let x=tt+b,w=j+B,I=tt,L=j;function V($,rt){switch($){case 1:return x+=rt,x-rt;case 2:return w+=rt,w-rt;case 3:return I-=rt,I+rt;case 0:return L-=rt,L+rt}}y.forEach(($,rt)=>{if($.show&&$._show){let ft=$.side;$._pos=V(ft,$._size),$.label!=null&&($._lpos=V(ft,$.labelSize))}})}let Bt=n.cursor=en({},G1,{drag:{y:s==2}},i.cursor);if(Bt.dataIdx==null){let x=Bt.hover,w=x.skip=new Set(x.skip??[]);w.add(void 0);let I=x.prox=me(x.prox),L=x.bias??=0;Bt.dataIdx=(V,$,rt,ft)=>{if($==0)return rt;let vt=rt,Lt=I(V,$,rt,ft)??ge,Dt=Lt>=0&&Lt<ge,kt=A.ori==0?b:B,ie=Bt.left,Fe=t[0],_e=t[$];if(w.has(_e[rt])){vt=null;let de=null,re=null,qt;if(L==0||L==-1)for(qt=rt;de==null&&qt-- >0;)w.has(_e[qt])||(de=qt);if(L==0||L==1)for(qt=rt;re==null&&qt++<_e.length;)w.has(_e[qt])||(re=qt);if(de!=null||re!=null)if(Dt){let Ie=de==null?-1/0:G(Fe[de],A,kt,0),Je=re==null?1/0:G(Fe[re],A,kt,0),Ze=ie-Ie,He=Je-ie;Ze<=He?Ze<=Lt&&(vt=de):He<=Lt&&(vt=re)}else vt=re==null?de:de==null?re:rt-de<=re-rt?de:re}else Dt&&ln(ie-G(Fe[rt],A,kt,0))>Lt&&(vt=null);return vt}}let fe=x=>{Bt.event=x};Bt.idxs=_t,Bt._lock=!1;let Pe=Bt.points;Pe.show=me(Pe.show),Pe.size=me(Pe.size),Pe.stroke=me(Pe.stroke),Pe.width=me(Pe.width),Pe.fill=me(Pe.fill);let un=n.focus=en({},i.focus||{alpha:.3},Bt.focus),$i=un.prox>=0,Zi=$i&&Pe.one,Ke=[],Pi=[],Ji=[];function Mo(x,w){let I=Pe.show(n,w);if(I)return Zn(I,zw),Zn(I,x.class),Wi(I,-10,-10,b,B),_.insertBefore(I,Ke[w]),I}function Os(x,w){if(s==1||w>0){let I=s==1&&U[x.scale].time,L=x.value;x.value=I?ag(L)?pg(Y,dg(L,nt)):L||at:L||Q1,x.label=x.label||(I?X1:W1)}if(Zi||w>0){x.width=x.width==null?1:x.width,x.paths=x.paths||dE||i1,x.fillTo=me(x.fillTo||sE),x.pxAlign=+Se(x.pxAlign,g),x.pxRound=Sg(x.pxAlign),x.stroke=me(x.stroke||null),x.fill=me(x.fill||null),x._stroke=x._fill=x._paths=x._focus=null;let I=tE(Tn(1,x.width),1),L=x.points=en({},{size:I,width:Tn(1,I*.2),stroke:x.stroke,space:I*2,paths:pE,_stroke:null,_fill:null},x.points);L.show=me(L.show),L.filter=me(L.filter),L.fill=me(L.fill),L.stroke=me(L.stroke),L.paths=me(L.paths),L.pxAlign=x.pxAlign}if(Zt){let I=ut(x,w);Ft.splice(w,0,I[0]),Yt.splice(w,0,I[1]),pt.values.push(null)}if(Bt.show){_t.splice(w,0,null);let I=null;Zi?w==0&&(I=Mo(x,w)):w>0&&(I=Mo(x,w)),Ke.splice(w,0,I),Pi.splice(w,0,0),Ji.splice(w,0,0)}mn("addSeries",w)}function ua(x,w){w=w??v.length,x=s==1?Of(x,w,gg,Mg):Of(x,w,{},vg),v.splice(w,0,x),Os(v[w],w)}n.addSeries=ua;function gr(x){if(v.splice(x,1),Zt){pt.values.splice(x,1),Yt.splice(x,1);let w=Ft.splice(x,1)[0];Jt(null,w.firstChild),w.remove()}Bt.show&&(_t.splice(x,1),Ke.splice(x,1)[0].remove(),Pi.splice(x,1),Ji.splice(x,1)),mn("delSeries",x)}n.delSeries=gr;let Ii=[!1,!1,!1,!1];function fa(x,w){if(x._show=x.show,x.show){let I=x.side%2,L=U[x.scale];L==null&&(x.scale=I?v[1].scale:P,L=U[x.scale]);let V=L.time;x.size=me(x.size),x.space=me(x.space),x.rotate=me(x.rotate),Ns(x.incrs)&&x.incrs.forEach(rt=>{!Fs.has(rt)&&Fs.set(rt,Lg(rt))}),x.incrs=me(x.incrs||(L.distr==2?E1:V?S==1?A1:P1:cr)),x.splits=me(x.splits||(V&&L.distr==1?Q:L.distr==3?Df:L.distr==4?$1:Y1)),x.stroke=me(x.stroke),x.grid.stroke=me(x.grid.stroke),x.ticks.stroke=me(x.ticks.stroke),x.border.stroke=me(x.border.stroke);let $=x.values;x.values=Ns($)&&!Ns($[0])?me($):V?Ns($)?fg(Y,ug($,nt)):ag($)?D1(Y,$):$||dt:$||q1,x.filter=me(x.filter||(L.distr>=3&&L.log==10?K1:L.distr==3&&L.log==2?j1:Pg)),x.font=Ag(x.font),x.labelFont=Ag(x.labelFont),x._size=x.size(n,null,w,0),x._space=x._rotate=x._incrs=x._found=x._splits=x._values=null,x._size>0&&(Ii[w]=!0,x._el=hi(Nw,d))}}function Bs(x,w,I,L){let[V,$,rt,ft]=I,vt=w%2,Lt=0;return vt==0&&(ft||$)&&(Lt=w==0&&!V||w==2&&!rt?an(mg.size/3):0),vt==1&&(V||rt)&&(Lt=w==1&&!$||w==3&&!ft?an(xg.size/2):0),Lt}let da=n.padding=(i.padding||[Bs,Bs,Bs,Bs]).map(x=>me(Se(x,Bs))),Li=n._padding=da.map((x,w)=>x(n,w,Ii,0)),T,k=null,q=null,K=s==1?v[0].idxs:null,H=null,yt=!1;function Ct(x,w){if(t=x??[],n.data=n._data=t,s==2){T=0;for(let I=1;I<v.length;I++)T+=t[I][0].length}else{t.length==0&&(n.data=n._data=t=[[]]),H=t[0],T=H.length;let I=t;if(W==2){I=t.slice();let L=I[0]=Array(T);for(let V=0;V<T;V++)L[V]=V}n._data=t=I}if(_r(!0),mn("setData"),W==2&&(ae=!0),w!==!1){let I=A;I.auto(n,yt)?Gt():xs(P,I.min,I.max),ee=ee||Bt.left>=0,z=!0,xr()}}n.setData=Ct;function Gt(){yt=!0;let x,w;s==1&&(T>0?(k=K[0]=0,q=K[1]=T-1,x=t[0][k],w=t[0][q],W==2?(x=k,w=q):x==w&&(W==3?[x,w]=tc(x,x,A.log,!1):W==4?[x,w]=Vf(x,x,A.log,!1):A.time?w=x+an(86400/S):[x,w]=jl(x,w,Hf,!0))):(k=K[0]=x=null,q=K[1]=w=null)),xs(P,x,w)}let Ht,jt,ne,Wt,pe,Te,Ce,fn,ye,zt;function Qn(x,w,I,L,V,$){x??=Gm,I??=Wf,L??="butt",V??=Gm,$??="round",x!=Ht&&(u.strokeStyle=Ht=x),V!=jt&&(u.fillStyle=jt=V),w!=ne&&(u.lineWidth=ne=w),$!=pe&&(u.lineJoin=pe=$),L!=Te&&(u.lineCap=Te=L),I!=Wt&&u.setLineDash(Wt=I)}function Me(x,w,I,L){w!=jt&&(u.fillStyle=jt=w),x!=Ce&&(u.font=Ce=x),I!=fn&&(u.textAlign=fn=I),L!=ye&&(u.textBaseline=ye=L)}function An(x,w,I,L,V=0){if(L.length>0&&x.auto(n,yt)&&(w==null||w.min==null)){let $=Se(k,0),rt=Se(q,L.length-1),ft=I.min==null?x.distr==3?Kw(L,$,rt):Jw(L,$,rt,V):[I.min,I.max];x.min=fi(x.min,I.min=ft[0]),x.max=Tn(x.max,I.max=ft[1])}}let Ki={min:null,max:null};function Cn(){for(let L in U){let V=U[L];Z[L]==null&&(V.min==null||Z[P]!=null&&V.auto(n,yt))&&(Z[L]=Ki)}for(let L in U){let V=U[L];Z[L]==null&&V.from!=null&&Z[V.from]!=null&&(Z[L]=Ki)}Z[P]!=null&&_r(!0);let x={};for(let L in Z){let V=Z[L];if(V!=null){let $=x[L]=po(U[L],o1);if(V.min!=null)en($,V);else if(L!=P||s==2)if(T==0&&$.from==null){let rt=$.range(n,null,null,L);$.min=rt[0],$.max=rt[1]}else $.min=ge,$.max=-ge}}if(T>0){v.forEach((L,V)=>{if(s==1){let $=L.scale,rt=Z[$];if(rt==null)return;let ft=x[$];if(V==0){let vt=ft.range(n,ft.min,ft.max,$);ft.min=vt[0],ft.max=vt[1],k=Ai(ft.min,t[0]),q=Ai(ft.max,t[0]),q-k>1&&(t[0][k]<ft.min&&k++,t[0][q]>ft.max&&q--),L.min=H[k],L.max=H[q]}else L.show&&L.auto&&An(ft,rt,L,t[V],L.sorted);L.idxs[0]=k,L.idxs[1]=q}else if(V>0&&L.show&&L.auto){let[$,rt]=L.facets,ft=$.scale,vt=rt.scale,[Lt,Dt]=t[V],kt=x[ft],ie=x[vt];kt!=null&&An(kt,Z[ft],$,Lt,$.sorted),ie!=null&&An(ie,Z[vt],rt,Dt,rt.sorted),L.min=rt.min,L.max=rt.max}});for(let L in x){let V=x[L],$=Z[L];if(V.from==null&&($==null||$.min==null)){let rt=V.range(n,V.min==ge?null:V.min,V.max==-ge?null:V.max,L);V.min=rt[0],V.max=rt[1]}}}for(let L in x){let V=x[L];if(V.from!=null){let $=x[V.from];if($.min==null)V.min=V.max=null;else{let rt=V.range(n,$.min,$.max,L);V.min=rt[0],V.max=rt[1]}}}let w={},I=!1;for(let L in x){let V=x[L],$=U[L];if($.min!=V.min||$.max!=V.max){$.min=V.min,$.max=V.max;let rt=$.distr;$._min=rt==3?ds($.min):rt==4?wf($.min,$.asinh):rt==100?$.fwd($.min):$.min,$._max=rt==3?ds($.max):rt==4?wf($.max,$.asinh):rt==100?$.fwd($.max):$.max,w[L]=I=!0}}if(I){v.forEach((L,V)=>{s==2?V>0&&w.y&&(L._paths=null):w[L.scale]&&(L._paths=null)});for(let L in w)ae=!0,mn("setScale",L);Bt.show&&Bt.left>=0&&(ee=z=!0)}for(let L in Z)Z[L]=null}function zs(x){let w=Lf(k-1,0,T-1),I=Lf(q+1,0,T-1);for(;x[w]==null&&w>0;)w--;for(;x[I]==null&&I<T-1;)I++;return[w,I]}function Ne(){T>0&&(v.forEach((x,w)=>{if(w>0&&x.show&&(Gn(w,!1),Gn(w,!0),x._paths==null)){zt!=x.alpha&&(u.globalAlpha=zt=x.alpha);let I=s==2?[0,t[w][0].length-1]:zs(t[w]);x._paths=x.paths(n,w,I[0],I[1]),zt!=1&&(u.globalAlpha=zt=1)}}),v.forEach((x,w)=>{if(w>0&&x.show){zt!=x.alpha&&(u.globalAlpha=zt=x.alpha),x._paths!=null&&gs(w,!1);{let I=x._paths!=null?x._paths.gaps:null,L=x.points.show(n,w,k,q,I),V=x.points.filter(n,w,L,I);(L||V)&&(x.points._paths=x.points.paths(n,w,k,q,V),gs(w,!0))}zt!=1&&(u.globalAlpha=zt=1),mn("drawSeries",w)}}))}function Gn(x,w){let I=w?v[x].points:v[x];I._stroke=I.stroke(n,x),I._fill=I.fill(n,x)}function gs(x,w){let I=w?v[x].points:v[x],{stroke:L,fill:V,clip:$,flags:rt,_stroke:ft=I._stroke,_fill:vt=I._fill,_width:Lt=I.width}=I._paths;Lt=Oe(Lt*Ee,3);let Dt=null,kt=Lt%2/2;w&&vt==null&&(vt=Lt>0?"#fff":ft);let ie=I.pxAlign==1&&kt>0;if(ie&&u.translate(kt,kt),!w){let Fe=Kt-Lt/2,_e=ct-Lt/2,de=wt+Lt,re=Xt+Lt;Dt=new Path2D,Dt.rect(Fe,_e,de,re)}w?ti(ft,Lt,I.dash,I.cap,vt,L,V,rt,$):Fn(x,ft,Lt,I.dash,I.cap,vt,L,V,rt,Dt,$),ie&&u.translate(-kt,-kt)}function Fn(x,w,I,L,V,$,rt,ft,vt,Lt,Dt){let kt=!1;vt!=0&&R.forEach((ie,Fe)=>{if(ie.series[0]==x){let _e=v[ie.series[1]],de=t[ie.series[1]],re=(_e._paths||na).band;Ns(re)&&(re=ie.dir==1?re[0]:re[1]);let qt,Ie=null;_e.show&&re&&Qw(de,k,q)?(Ie=ie.fill(n,Fe)||$,qt=_e._paths.clip):re=null,ti(w,I,L,V,Ie,rt,ft,vt,Lt,Dt,qt,re),kt=!0}}),kt||ti(w,I,L,V,$,rt,ft,vt,Lt,Dt)}let di=mo|Nf;function ti(x,w,I,L,V,$,rt,ft,vt,Lt,Dt,kt){Qn(x,w,I,L,V),(vt||Lt||kt)&&(u.save(),vt&&u.clip(vt),Lt&&u.clip(Lt)),kt?(ft&di)==di?(u.clip(kt),Dt&&u.clip(Dt),pa(V,rt),ks(x,$,w)):ft&Nf?(pa(V,rt),u.clip(kt),ks(x,$,w)):ft&mo&&(u.save(),u.clip(kt),Dt&&u.clip(Dt),pa(V,rt),u.restore(),ks(x,$,w)):(pa(V,rt),ks(x,$,w)),(vt||Lt||kt)&&u.restore()}function ks(x,w,I){I>0&&(w instanceof Map?w.forEach((L,V)=>{u.strokeStyle=Ht=V,u.stroke(L)}):w!=null&&x&&u.stroke(w))}function pa(x,w){w instanceof Map?w.forEach((I,L)=>{u.fillStyle=jt=L,u.fill(I)}):w!=null&&x&&u.fill(w)}function n_(x,w,I,L){let V=y[x],$;if(L<=0)$=[0,0];else{let rt=V._space=V.space(n,x,w,I,L),ft=V._incrs=V.incrs(n,x,w,I,L,rt);$=vE(w,I,ft,L,rt)}return V._found=$}function Uc(x,w,I,L,V,$,rt,ft,vt,Lt){let Dt=rt%2/2;g==1&&u.translate(Dt,Dt),Qn(ft,rt,vt,Lt,ft),u.beginPath();let kt,ie,Fe,_e,de=V+(L==0||L==3?-$:$);I==0?(ie=V,_e=de):(kt=V,Fe=de);for(let re=0;re<x.length;re++)w[re]!=null&&(I==0?kt=Fe=x[re]:ie=_e=x[re],u.moveTo(kt,ie),u.lineTo(Fe,_e));u.stroke(),g==1&&u.translate(-Dt,-Dt)}function i_(x){let w=!0;return y.forEach((I,L)=>{if(!I.show)return;let V=U[I.scale];if(V.min==null){I._show&&(w=!1,I._show=!1,_r(!1));return}else I._show||(w=!1,I._show=!0,_r(!1));let $=I.side,rt=$%2,{min:ft,max:vt}=V,[Lt,Dt]=n_(L,ft,vt,rt==0?b:B);if(Dt==0)return;let kt=V.distr==2,ie=I._splits=I.splits(n,L,ft,vt,Lt,Dt,kt),Fe=V.distr==2?ie.map(qt=>H[qt]):ie,_e=V.distr==2?H[ie[1]]-H[ie[0]]:Lt,de=I._values=I.values(n,I.filter(n,Fe,L,Dt,_e),L,Dt,_e);I._rotate=$==2?I.rotate(n,de,L,Dt):0;let re=I._size;I._size=ui(I.size(n,de,L,x)),re!=null&&I._size!=re&&(w=!1)}),w}function s_(x){let w=!0;return da.forEach((I,L)=>{let V=I(n,L,Ii,x);V!=Li[L]&&(w=!1),Li[L]=V}),w}function r_(){for(let x=0;x<y.length;x++){let w=y[x];if(!w.show||!w._show)continue;let I=w.side,L=I%2,V,$,rt=w.stroke(n,x),ft=I==0||I==3?-1:1;if(w.label){let In=w.labelGap*ft,Wn=an((w._lpos+In)*Ee);Me(w.labelFont[0],rt,"center",I==2?Jo:Hm),u.save(),L==1?(V=$=0,u.translate(Wn,an(ct+Xt/2)),u.rotate((I==3?-Jl:Jl)/2)):(V=an(Kt+wt/2),$=Wn),u.fillText(w.label,V,$),u.restore()}let[vt,Lt]=w._found;if(Lt==0)continue;let Dt=U[w.scale],kt=L==0?wt:Xt,ie=L==0?Kt:ct,Fe=an(w.gap*Ee),_e=w._splits,de=Dt.distr==2?_e.map(In=>H[In]):_e,re=Dt.distr==2?H[_e[1]]-H[_e[0]]:vt,qt=w.ticks,Ie=w.border,Je=qt.show?an(qt.size*Ee):0,Ze=w._rotate*-Jl/180,He=p(w._pos*Ee),Qe=(Je+Fe)*ft,On=He+Qe;$=L==0?On:0,V=L==1?On:0;let Bn=w.font[0],ei=w.align==1?ao:w.align==2?bf:Ze>0?ao:Ze<0?bf:L==0?"center":I==3?bf:ao,pi=Ze||L==1?"middle":I==2?Jo:Hm;Me(Bn,rt,ei,pi);let mi=w.font[1]*w.lineGap,Rn=_e.map(In=>p(l(In,Dt,kt,ie))),Ni=w._values;for(let In=0;In<Ni.length;In++){let Wn=Ni[In];if(Wn!=null){L==0?V=Rn[In]:$=Rn[In],Wn=""+Wn;let Tr=Wn.indexOf(`
`)==-1?[Wn]:Wn.split(/\n/gm);for(let Ms=0;Ms<Tr.length;Ms++){let ni=Tr[Ms];Ze?(u.save(),u.translate(V,$+Ms*mi),u.rotate(Ze),u.fillText(ni,0,0),u.restore()):u.fillText(ni,V,$+Ms*mi)}}}qt.show&&Uc(Rn,qt.filter(n,de,x,Lt,re),L,I,He,Je,Oe(qt.width*Ee,3),qt.stroke(n,x),qt.dash,qt.cap);let Pn=w.grid;Pn.show&&Uc(Rn,Pn.filter(n,de,x,Lt,re),L,L==0?2:1,L==0?ct:Kt,L==0?Xt:wt,Oe(Pn.width*Ee,3),Pn.stroke(n,x),Pn.dash,Pn.cap),Ie.show&&Uc([He],[1],L==0?1:0,L==0?1:2,L==1?ct:Kt,L==1?Xt:wt,Oe(Ie.width*Ee,3),Ie.stroke(n,x),Ie.dash,Ie.cap)}mn("drawAxes")}function _r(x){v.forEach((w,I)=>{I>0&&(w._paths=null,x&&(s==1?(w.min=null,w.max=null):w.facets.forEach(L=>{L.min=null,L.max=null})))})}let ma=!1,Nc=!1,bo=[];function o_(){Nc=!1;for(let x=0;x<bo.length;x++)mn(...bo[x]);bo.length=0}function xr(){ma||(d1(pd),ma=!0)}function a_(x,w=!1){ma=!0,Nc=w,x(n),pd(),w&&bo.length>0&&queueMicrotask(o_)}n.batch=a_;function pd(){if($t&&(Cn(),$t=!1),ae&&(It(),ae=!1),Rt){if(Ge(m,ao,tt),Ge(m,Jo,j),Ge(m,jo,b),Ge(m,Qo,B),Ge(_,ao,tt),Ge(_,Jo,j),Ge(_,jo,b),Ge(_,Qo,B),Ge(d,jo,St),Ge(d,Qo,C),f.width=an(St*Ee),f.height=an(C*Ee),y.forEach(({_el:x,_show:w,_size:I,_pos:L,side:V})=>{if(x!=null)if(w){let $=V===3||V===0?I:0,rt=V%2==1;Ge(x,rt?"left":"top",L-$),Ge(x,rt?"width":"height",I),Ge(x,rt?"top":"left",rt?j:tt),Ge(x,rt?"height":"width",rt?B:b),Pf(x,hr)}else Zn(x,hr)}),Ht=jt=ne=pe=Te=Ce=fn=ye=Wt=null,zt=1,Eo(!0),tt!=et||j!=Nt||b!=Mt||B!=At){_r(!1);let x=b/Mt,w=B/At;if(Bt.show&&!ee&&Bt.left>=0){Bt.left*=x,Bt.top*=w,yr&&Wi(yr,an(Bt.left),0,b,B),vr&&Wi(vr,0,an(Bt.top),b,B);for(let I=0;I<Ke.length;I++){let L=Ke[I];L!=null&&(Pi[I]*=x,Ji[I]*=w,Wi(L,ui(Pi[I]),ui(Ji[I]),b,B))}}if(Ve.show&&!we&&Ve.left>=0&&Ve.width>0){Ve.left*=x,Ve.width*=x,Ve.top*=w,Ve.height*=w;for(let I in Vc)Ge(Sr,I,Ve[I])}et=tt,Nt=j,Mt=b,At=B}mn("setSize"),Rt=!1}St>0&&C>0&&(u.clearRect(0,0,f.width,f.height),mn("drawClear"),E.forEach(x=>x()),mn("draw")),Ve.show&&we&&(ga(Ve),we=!1),Bt.show&&ee&&(Hs(null,!0,!1),ee=!1),pt.show&&pt.live&&z&&(zc(),z=!1),c||(c=!0,n.status=1,mn("ready")),yt=!1,ma=!1}n.redraw=(x,w)=>{ae=w||!1,x!==!1?xs(P,A.min,A.max):xr()};function Fc(x,w){let I=U[x];if(I.from==null){if(T==0){let L=I.range(n,w.min,w.max,x);w.min=L[0],w.max=L[1]}if(w.min>w.max){let L=w.min;w.min=w.max,w.max=L}if(T>1&&w.min!=null&&w.max!=null&&w.max-w.min<1e-16)return;x==P&&I.distr==2&&T>0&&(w.min=Ai(w.min,t[0]),w.max=Ai(w.max,t[0]),w.min==w.max&&w.max++),Z[x]=w,$t=!0,xr()}}n.setScale=Fc;let Oc,Bc,yr,vr,md,gd,Mr,br,_d,xd,ke,Xe,_s=!1,_n=Bt.drag,dn=_n.x,pn=_n.y;Bt.show&&(Bt.x&&(Oc=hi(Ow,_)),Bt.y&&(Bc=hi(Bw,_)),A.ori==0?(yr=Oc,vr=Bc):(yr=Bc,vr=Oc),ke=Bt.left,Xe=Bt.top);let Ve=n.select=en({show:!0,over:!0,left:0,width:0,top:0,height:0},i.select),Sr=Ve.show?hi(Fw,Ve.over?_:m):null;function ga(x,w){if(Ve.show){for(let I in x)Ve[I]=x[I],I in Vc&&Ge(Sr,I,x[I]);w!==!1&&mn("setSelect")}}n.setSelect=ga;function l_(x,w){let I=v[x],L=Zt?Ft[x]:null;if(I.show)L&&Pf(L,hr);else{L&&Zn(L,hr);let V=Zi?Ke[0]:Ke[x];Wi(V,-10,-10,b,B)}}function xs(x,w,I){Fc(x,{min:w,max:I})}function Di(x,w,I,L){w.focus!=null&&d_(x),w.show!=null&&v.forEach((V,$)=>{$>0&&(x==$||x==null)&&(V.show=w.show,l_($,w.show),s==2?(xs(V.facets[0].scale,null,null),xs(V.facets[1].scale,null,null)):xs(V.scale,null,null),xr())}),I!==!1&&mn("setSeries",x,w),L&&To("setSeries",n,x,w)}n.setSeries=Di;function c_(x,w){en(R[x],w)}function h_(x,w){x.fill=me(x.fill||null),x.dir=Se(x.dir,-1),w=w??R.length,R.splice(w,0,x)}function u_(x){x==null?R.length=0:R.splice(x,1)}n.addBand=h_,n.setBand=c_,n.delBand=u_;function f_(x,w){v[x].alpha=w,Bt.show&&Ke[x]&&(Ke[x].style.opacity=w),Zt&&Ft[x]&&(Ft[x].style.opacity=w)}let ji,ys,Vs,wr={focus:!0};function d_(x){if(x!=Vs){let w=x==null,I=un.alpha!=1;v.forEach((L,V)=>{if(s==1||V>0){let $=w||V==0||V==x;L._focus=w?null:$,I&&f_(V,$?1:un.alpha)}}),Vs=x,I&&xr()}}Zt&&$i&&xt(Ym,ht,x=>{Bt._lock||(fe(x),Vs!=null&&Di(null,wr,!0,je.setSeries))});function Ui(x,w,I){let L=U[w];I&&(x=x/Ee-(L.ori==1?j:tt));let V=b;L.ori==1&&(V=B,x=V-x),L.dir==-1&&(x=V-x);let $=L._min,rt=L._max,ft=x/V,vt=$+(rt-$)*ft,Lt=L.distr;return Lt==3?uo(10,vt):Lt==4?e1(vt,L.asinh):Lt==100?L.bwd(vt):vt}function p_(x,w){let I=Ui(x,P,w);return Ai(I,t[0],k,q)}n.valToIdx=x=>Ai(x,t[0]),n.posToIdx=p_,n.posToVal=Ui,n.valToPos=(x,w,I)=>U[w].ori==0?o(x,U[w],I?wt:b,I?Kt:0):a(x,U[w],I?Xt:B,I?ct:0),n.setCursor=(x,w,I)=>{ke=x.left,Xe=x.top,Hs(null,w,I)};function yd(x,w){Ge(Sr,ao,Ve.left=x),Ge(Sr,jo,Ve.width=w)}function vd(x,w){Ge(Sr,Jo,Ve.top=x),Ge(Sr,Qo,Ve.height=w)}let So=A.ori==0?yd:vd,wo=A.ori==1?yd:vd;function m_(){if(Zt&&pt.live)for(let x=s==2?1:0;x<v.length;x++){if(x==0&&te)continue;let w=pt.values[x],I=0;for(let L in w)Yt[x][I++].firstChild.nodeValue=w[L]}}function zc(x,w){if(x!=null&&(x.idxs?x.idxs.forEach((I,L)=>{_t[L]=I}):r1(x.idx)||_t.fill(x.idx),pt.idx=_t[0]),Zt&&pt.live){for(let I=0;I<v.length;I++)(I>0||s==1&&!te)&&g_(I,_t[I]);m_()}z=!1,w!==!1&&mn("setLegend")}n.setLegend=zc;function g_(x,w){let I=v[x],L=x==0&&W==2?H:t[x],V;te?V=I.values(n,x,w)??st:(V=I.value(n,w==null?null:L[w],x,w),V=V==null?st:{_:V}),pt.values[x]=V}function Hs(x,w,I){_d=ke,xd=Xe,[ke,Xe]=Bt.move(n,ke,Xe),Bt.left=ke,Bt.top=Xe,Bt.show&&(yr&&Wi(yr,an(ke),0,b,B),vr&&Wi(vr,0,an(Xe),b,B));let L,V=k>q;ji=ge,ys=null;let $=A.ori==0?b:B,rt=A.ori==1?b:B;if(ke<0||T==0||V){L=Bt.idx=null;for(let ft=0;ft<v.length;ft++){let vt=Ke[ft];vt!=null&&Wi(vt,-10,-10,b,B)}$i&&Di(null,wr,!0,x==null&&je.setSeries),pt.live&&(_t.fill(L),z=!0)}else{let ft,vt,Lt;s==1&&(ft=A.ori==0?ke:Xe,vt=Ui(ft,P),L=Bt.idx=Ai(vt,t[0],k,q),Lt=G(t[0][L],A,$,0));let Dt=-10,kt=-10,ie=0,Fe=0,_e=!0,de="",re="";for(let qt=s==2?1:0;qt<v.length;qt++){let Ie=v[qt],Je=_t[qt],Ze=Je==null?null:s==1?t[qt][Je]:t[qt][1][Je],He=Bt.dataIdx(n,qt,L,vt),Qe=He==null?null:s==1?t[qt][He]:t[qt][1][He];z=z||Qe!=Ze||He!=Je,_t[qt]=He;let On=He==L?Lt:G(s==1?t[0][He]:t[qt][0][He],A,$,0);if(qt>0&&Ie.show){let Bn=Qe==null?-10:X(Qe,s==1?U[Ie.scale]:U[Ie.facets[1].scale],rt,0);if($i&&Qe!=null){let ei=A.ori==1?ke:Xe,pi=ln(un.dist(n,qt,He,Bn,ei));if(pi<ji){let mi=un.bias;if(mi!=0){let Rn=Ui(ei,Ie.scale),Ni=Qe>=0?1:-1,Pn=Rn>=0?1:-1;Pn==Ni&&(Pn==1?mi==1?Qe>=Rn:Qe<=Rn:mi==1?Qe<=Rn:Qe>=Rn)&&(ji=pi,ys=qt)}else ji=pi,ys=qt}}if(z||Zi){let ei,pi;A.ori==0?(ei=On,pi=Bn):(ei=Bn,pi=On);let mi,Rn,Ni,Pn,In,Wn,Tr=!0,Ms=Pe.bbox;if(Ms!=null){Tr=!1;let ni=Ms(n,qt);Ni=ni.left,Pn=ni.top,mi=ni.width,Rn=ni.height}else Ni=ei,Pn=pi,mi=Rn=Pe.size(n,qt);if(Wn=Pe.fill(n,qt),In=Pe.stroke(n,qt),Zi)qt==ys&&ji<=un.prox&&(Dt=Ni,kt=Pn,ie=mi,Fe=Rn,_e=Tr,de=Wn,re=In);else{let ni=Ke[qt];ni!=null&&(Pi[qt]=Ni,Ji[qt]=Pn,tg(ni,mi,Rn,Tr),jm(ni,Wn,In),Wi(ni,ui(Ni),ui(Pn),b,B))}}}}if(Zi){let qt=un.prox,Ie=Vs==null?ji<=qt:ji>qt||ys!=Vs;if(z||Ie){let Je=Ke[0];Pi[0]=Dt,Ji[0]=kt,tg(Je,ie,Fe,_e),jm(Je,de,re),Wi(Je,ui(Dt),ui(kt),b,B)}}}if(Ve.show&&_s)if(x!=null){let[ft,vt]=je.scales,[Lt,Dt]=je.match,[kt,ie]=x.cursor.sync.scales,Fe=x.cursor.drag;if(dn=Fe._x,pn=Fe._y,dn||pn){let{left:_e,top:de,width:re,height:qt}=x.select,Ie=x.scales[kt].ori,Je=x.posToVal,Ze,He,Qe,On,Bn,ei=ft!=null&&Lt(ft,kt),pi=vt!=null&&Dt(vt,ie);ei&&dn?(Ie==0?(Ze=_e,He=re):(Ze=de,He=qt),Qe=U[ft],On=G(Je(Ze,kt),Qe,$,0),Bn=G(Je(Ze+He,kt),Qe,$,0),So(fi(On,Bn),ln(Bn-On))):So(0,$),pi&&pn?(Ie==1?(Ze=_e,He=re):(Ze=de,He=qt),Qe=U[vt],On=X(Je(Ze,ie),Qe,rt,0),Bn=X(Je(Ze+He,ie),Qe,rt,0),wo(fi(On,Bn),ln(Bn-On))):wo(0,rt)}else _a()}else{let ft=ln(_d-md),vt=ln(xd-gd);if(A.ori==1){let ie=ft;ft=vt,vt=ie}dn=_n.x&&ft>=_n.dist,pn=_n.y&&vt>=_n.dist;let Lt=_n.uni;Lt!=null?dn&&pn&&(dn=ft>=Lt,pn=vt>=Lt,!dn&&!pn&&(vt>ft?pn=!0:dn=!0)):_n.x&&_n.y&&(dn||pn)&&(dn=pn=!0);let Dt,kt;dn&&(A.ori==0?(Dt=Mr,kt=ke):(Dt=br,kt=Xe),So(fi(Dt,kt),ln(kt-Dt)),pn||wo(0,rt)),pn&&(A.ori==1?(Dt=Mr,kt=ke):(Dt=br,kt=Xe),wo(fi(Dt,kt),ln(kt-Dt)),dn||So(0,$)),!dn&&!pn&&(So(0,0),wo(0,0))}if(_n._x=dn,_n._y=pn,x==null){if(I){if(Id!=null){let[ft,vt]=je.scales;je.values[0]=ft!=null?Ui(A.ori==0?ke:Xe,ft):null,je.values[1]=vt!=null?Ui(A.ori==1?ke:Xe,vt):null}To(Wm,n,ke,Xe,b,B,L)}if($i){let ft=I&&je.setSeries,vt=un.prox;Vs==null?ji<=vt&&Di(ys,wr,!0,ft):ji>vt?Di(null,wr,!0,ft):ys!=Vs&&Di(ys,wr,!0,ft)}}z&&(pt.idx=L,zc()),w!==!1&&mn("setCursor")}let vs=null;Object.defineProperty(n,"rect",{get(){return vs==null&&Eo(!1),vs}});function Eo(x=!1){x?vs=null:(vs=_.getBoundingClientRect(),mn("syncRect",vs))}function Md(x,w,I,L,V,$,rt){Bt._lock||_s&&x!=null&&x.movementX==0&&x.movementY==0||(kc(x,w,I,L,V,$,rt,!1,x!=null),x!=null?Hs(null,!0,!0):Hs(w,!0,!1))}function kc(x,w,I,L,V,$,rt,ft,vt){if(vs==null&&Eo(!1),fe(x),x!=null)I=x.clientX-vs.left,L=x.clientY-vs.top;else{if(I<0||L<0){ke=-10,Xe=-10;return}let[Lt,Dt]=je.scales,kt=w.cursor.sync,[ie,Fe]=kt.values,[_e,de]=kt.scales,[re,qt]=je.match,Ie=w.axes[0].side%2==1,Je=A.ori==0?b:B,Ze=A.ori==1?b:B,He=Ie?$:V,Qe=Ie?V:$,On=Ie?L:I,Bn=Ie?I:L;if(_e!=null?I=re(Lt,_e)?l(ie,U[Lt],Je,0):-10:I=Je*(On/He),de!=null?L=qt(Dt,de)?l(Fe,U[Dt],Ze,0):-10:L=Ze*(Bn/Qe),A.ori==1){let ei=I;I=L,L=ei}}vt&&((I<=1||I>=b-1)&&(I=lr(I,b)),(L<=1||L>=B-1)&&(L=lr(L,B))),ft?(md=I,gd=L,[Mr,br]=Bt.move(n,I,L)):(ke=I,Xe=L)}let Vc={width:0,height:0,left:0,top:0};function _a(){ga(Vc,!1)}let bd,Sd,wd,Ed;function Td(x,w,I,L,V,$,rt){_s=!0,dn=pn=_n._x=_n._y=!1,kc(x,w,I,L,V,$,rt,!0,!1),x!=null&&(xt(Sf,Cf,Ad,!1),To(Xm,n,Mr,br,b,B,null));let{left:ft,top:vt,width:Lt,height:Dt}=Ve;bd=ft,Sd=vt,wd=Lt,Ed=Dt,_a()}function Ad(x,w,I,L,V,$,rt){_s=_n._x=_n._y=!1,kc(x,w,I,L,V,$,rt,!1,!0);let{left:ft,top:vt,width:Lt,height:Dt}=Ve,kt=Lt>0||Dt>0,ie=bd!=ft||Sd!=vt||wd!=Lt||Ed!=Dt;if(kt&&ie&&ga(Ve),_n.setScale&&kt&&ie){let Fe=ft,_e=Lt,de=vt,re=Dt;if(A.ori==1&&(Fe=vt,_e=Dt,de=ft,re=Lt),dn&&xs(P,Ui(Fe,P),Ui(Fe+_e,P)),pn)for(let qt in U){let Ie=U[qt];qt!=P&&Ie.from==null&&Ie.min!=ge&&xs(qt,Ui(de+re,qt),Ui(de,qt))}_a()}else Bt.lock&&(Bt._lock=!Bt._lock,Hs(null,!0,!1));x!=null&&(Jt(Sf,Cf),To(Sf,n,ke,Xe,b,B,null))}function __(x,w,I,L,V,$,rt){if(Bt._lock)return;fe(x);let ft=_s;if(_s){let vt=!0,Lt=!0,Dt=10,kt,ie;A.ori==0?(kt=dn,ie=pn):(kt=pn,ie=dn),kt&&ie&&(vt=ke<=Dt||ke>=b-Dt,Lt=Xe<=Dt||Xe>=B-Dt),kt&&vt&&(ke=ke<Mr?0:b),ie&&Lt&&(Xe=Xe<br?0:B),Hs(null,!0,!0),_s=!1}ke=-10,Xe=-10,Hs(null,!0,!0),ft&&(_s=ft)}function Cd(x,w,I,L,V,$,rt){Bt._lock||(fe(x),Gt(),_a(),x!=null&&To($m,n,ke,Xe,b,B,null))}function Rd(){y.forEach(ME),Et(n.width,n.height,!0)}ur(Kl,co,Rd);let Er={};Er.mousedown=Td,Er.mousemove=Md,Er.mouseup=Ad,Er.dblclick=Cd,Er.setSeries=(x,w,I,L)=>{let V=je.match[2];I=V(n,w,I),I!=-1&&Di(I,L,!0,!1)},Bt.show&&(xt(Xm,_,Td),xt(Wm,_,Md),xt(qm,_,x=>{fe(x),Eo(!1)}),xt(Ym,_,__),xt($m,_,Cd),Ff.add(n),n.syncRect=Eo);let xa=n.hooks=i.hooks||{};function mn(x,w,I){Nc?bo.push([x,w,I]):x in xa&&xa[x].forEach(L=>{L.call(null,n,w,I)})}(i.plugins||[]).forEach(x=>{for(let w in x.hooks)xa[w]=(xa[w]||[]).concat(x.hooks[w])});let Pd=(x,w,I)=>I,je=en({key:null,setSeries:!1,filters:{pub:rg,sub:rg},scales:[P,v[1]?v[1].scale:null],match:[og,og,Pd],values:[null,null]},Bt.sync);je.match.length==2&&je.match.push(Pd),Bt.sync=je;let Id=je.key,Hc=jg(Id);function To(x,w,I,L,V,$,rt){je.filters.pub(x,w,I,L,V,$,rt)&&Hc.pub(x,w,I,L,V,$,rt)}Hc.sub(n);function x_(x,w,I,L,V,$,rt){je.filters.sub(x,w,I,L,V,$,rt)&&Er[x](null,w,I,L,V,$,rt)}n.pub=x_;function y_(){Hc.unsub(n),Ff.delete(n),Tt.clear(),If(Kl,co,Rd),h.remove(),ht?.remove(),mn("destroy")}n.destroy=y_;function Gc(){mn("init",i,t),Ct(t||i.data,!1),Z[P]?Fc(P,Z[P]):Gt(),we=Ve.show&&(Ve.width>0||Ve.height>0),ee=z=!0,Et(i.width,i.height)}return v.forEach(Os),y.forEach(fa),e?e instanceof HTMLElement?(e.appendChild(h),Gc()):e(n,Gc):Gc(),n}xn.assign=en;xn.fmtNum=Gf;xn.rangeNum=jl;xn.rangeLog=tc;xn.rangeAsinh=Vf;xn.orient=dr;xn.pxRatio=Ee;xn.join=f1;xn.fmtDate=Xf,xn.tzDate=S1;xn.sync=jg;{xn.addGap=rE,xn.clipGaps=ic;let i=xn.paths={points:s0};i.linear=o0,i.stepped=lE,i.bars=cE,i.spline=uE}var jn=["series-1","series-2","series-3","series-4","series-5","series-6","series-7","series-8"],u0=[[],[8,4],[2,3]],h0=8,jf=5,ac=i=>i.map(t=>t===null?null:-t);function Qf(i,t){return[SE(i,t),wE(i,t),EE(i,t),TE(i,t),AE(i),CE(i,t),RE(i),PE(i),IE(i),LE(i),DE(i)].filter(n=>n&&n.figures.length)}var bE=i=>i.meta.source==="truth"?"flown":"flown (estimate)";function SE(i,t){let e=i.flown("position"),{t:n}=e,s=i.channel("reference.position"),r=$e(e,n),o=s&&$e(s,n),a=t&&$e(t.flown("position"),n);return{title:"Position of the payload",figures:["North","East","Altitude"].map((h,f)=>{let u=f===2?ac:m=>m,d=[];return o&&d.push({label:"reference",values:u(o[f]),color:"reference",width:3}),d.push({label:bE(i),values:u(r[f]),color:"flown"}),a&&d.push({label:"B flown",values:u(a[f]),color:"series-2",dash:[6,4]}),{title:h,unit:"m",t:n,series:d,digits:3}})}}function wE(i,t){let e=Xl(i);if(!e)return null;let n=[{spans:e.avoiding,color:"detected",label:"plan is off the reference: avoiding or waiting"}],s=[];if(i.has("plan.position")){let r=i.meta.summary.safety?.payload_tracking_bound_m;s.push({title:"Error: distance from the plan",unit:"m",t:e.t,zero:!0,digits:4,series:[{label:"error",values:e.error,color:"flown"}],lines:r?[{value:r,label:"bound of the guarantee"}]:[],shaded:n})}if(s.push({title:"Distance from the mission’s reference",unit:"m",t:e.t,zero:!0,digits:3,series:[{label:"distance",values:e.deviation,color:"flown"}],shaded:n}),t){let[r,o]=[i,t].map(a=>$e(a.flown("position"),e.t));s.push({title:"Distance between the payloads of A and B at the same time",unit:"m",t:e.t,zero:!0,digits:3,series:[{label:"B − A",values:$o(r,o),color:"series-2"}]})}return{title:"Error and avoidance",note:"An error is a distance from the plan. To avoid obstacles the plan itself leaves the reference, which is wanted (shaded).",figures:s}}function EE(i,t){let e=i.flown("attitude"),{t:n}=e,s=i.meta.summary.limits?.payload_tilt_deg?.limit,r=s?[{value:s,label:"limit"},{value:-s,label:""}]:[],o=xf(e),a=["roll","pitch","yaw"].map((c,h)=>({label:c,values:Array.from(o[h]),color:jn[h]}));if(t){let c=t.flown("attitude"),h=xf(c);["roll","pitch","yaw"].forEach((f,u)=>{a.push({label:`B ${f}`,values:_f(c.t,h[u],n),color:jn[u],dash:[6,4]})})}return{title:"Attitude of the payload",figures:[{title:"Roll, pitch and yaw (reference: 0)",unit:"°",t:n,series:a,lines:r,digits:2}]}}function TE(i,t){let e=i.channel("clearance.each")??i.channel("clearance.nearest");if(!e)return null;let n=i.meta.summary.limits?.clearance?.limit,s=$e(e,e.t).map((l,c)=>({label:e.columns[c],values:l,color:jn[c%jn.length]})),r=t?.channel("clearance.nearest");r&&s.push({label:"B nearest",values:$e(r,e.t)[0],color:"series-8",dash:[6,4]});let o=[{value:i.meta.margin,label:"margin of plans"}];n&&(n===i.meta.margin?o[0].label="margin of plans, limit":o.push({value:n,label:"limit"}));let a=Math.max(4*Math.max(i.meta.margin,n??0),2);return{title:"Clearance",note:"From the formation’s hull (payload and rotor discs) to the surface of each obstacle, on the true state.",figures:[{title:"Hull to obstacle",unit:"m",t:e.t,series:s,lines:o,digits:3,zero:!0},{title:`The same, below ${a} m`,unit:"m",t:e.t,series:s,lines:o,digits:3,range:[0,a]}]}}function AE(i){let t=i.channel("plan.clearance"),e=i.channel("plan.progress_rate"),n=i.channel("plan.slack"),s=i.channel("plan.verified");if(!s||!e)return null;let{t:r}=s,a=[{spans:ql(r,Array.from(s.series[0],f=>f<.5)),color:"bad",label:"plan not verified to keep the margin"}],l=[];t&&l.push({label:"least clearance of the plan",values:$e(t,r)[0],color:"plan"}),n&&l.push({label:"slack (violation)",values:$e(n,r)[0],color:"bad"});let c=i.channel("plan.solved");if(c){let f=ql(r,Array.from(c.series[0],u=>u<.5));a.push({spans:f,color:"reference",label:"no solution: the plan before, or a stop, is flown"})}let h=[];return l.length&&h.push({title:"Barrier: clearance of the plan over its horizon, at most the margin",unit:"m",t:r,series:l,zero:!0,digits:3,lines:[{value:i.meta.margin,label:"margin"}],shaded:a}),h.push({title:"Progress rate along the mission (1: as planned, 0: waiting)",unit:"1",t:r,zero:!0,digits:2,series:[{label:"progress rate",values:$e(e,r)[0],color:"flown"}]}),{title:"Safety filter",figures:h}}function CE(i,t){let e=i.channel("separation");if(!e)return null;let n=i.meta.summary.limits?.uav_separation?.limit,s=[{label:"nearest two",values:$e(e,e.t)[0],color:"flown"}],r=t?.channel("separation");r&&s.push({label:"B",values:$e(r,e.t)[0],color:"series-2",dash:[6,4]});let o={value:2*i.meta.disc_radius,label:"rotor discs touch"},a=n?[o,{value:n,label:"limit"}]:[o];return{title:"Distance between UAVs",figures:[{title:"Centres of the nearest two",unit:"m",t:e.t,series:s,lines:a,digits:3}]}}function RE(i){let t=[],e=i.channel("truth.thrust"),n=o=>$e(o,o.t).map((a,l)=>({label:o.columns[l],values:a,color:jn[l%jn.length],dash:u0[Math.floor(l/jn.length)%3]}));if(e){let o=[{value:i.meta.thrust_max,label:"largest thrust"}];t.push({title:"Thrust of each UAV",unit:"N",t:e.t,series:n(e),lines:o,zero:!0,digits:2})}let s=i.channel("truth.tension");if(s){let o=[{value:0,label:"below: compression"}];t.push({title:"Tension of each link",unit:"N",t:s.t,series:n(s),lines:o,digits:2})}let r=i.channel("estimate.disturbance");if(r){let o=$e(r,r.t),a=["north","east","up"].map((l,c)=>({label:l,values:c===2?ac(o[2]):o[c],color:jn[c]}));t.push({title:"Disturbance force on the payload, as estimated",unit:"N",t:r.t,series:a,digits:2})}return{title:"Forces",figures:t}}function PE(i){let t=i.channel("estimate.payload.position"),e=i.channel("truth.payload.position");if(!t||!e)return null;let{t:n}=t,s=i.channel("estimate.payload.position_sd"),[r,o]=[$e(t,n),$e(e,n)],a=s&&$e(s,n),l=["north","east","altitude"].map((h,f)=>{let u=r[f].map((g,p)=>g===null||o[f][p]===null?null:g-o[f][p]),d=f===2?ac(u):u,m=[],_=[];if(a){let g=a[f].map(p=>p===null?null:3*p);m.push({label:"+3σ",values:g,color:"reference",width:1}),m.push({label:"−3σ",values:ac(g),color:"reference",width:1}),_.push({low:2,high:1,color:"reference"})}return m.push({label:"estimate − truth",values:d,color:"estimate"}),{title:`Error of the estimate, ${h}`,unit:"m",t:n,series:m,bands:_,digits:4}});return{title:"Estimation",note:a?"Grey: three standard deviations, as the estimator states them.":"Standard deviations are not on record.",figures:l}}function IE(i){let t=i.names("innovations.");if(!t.length)return null;let e=t.map(c=>{let h=i.channel(c),[,f,u]=c.split("."),d=i.events.some(m=>m.kind==="isolation"&&m.source===f&&m.text===u);return{label:`${f} ${u}`,channel:h,isIsolated:d,most:Math.max(...Array.from(h.series[0]).filter(Number.isFinite),0)}});e.sort((c,h)=>Number(h.isIsolated)-Number(c.isIsolated)||h.most-c.most);let n=e.slice(0,h0),s=n.reduce((c,h)=>h.channel.t.length>c.channel.t.length?h:c),{t:r}=s.channel,o=n.map(({label:c,channel:h},f)=>({label:c,values:$e(h,r)[0],color:jn[f],dash:u0[0]})),a=[{value:1,label:"rejected above"}];return{title:"Innovation tests",note:`Above 1 a measurement is rejected.${e.length-n.length>0?` Shown are isolated channels, then those with the largest ratios: ${h0} of ${e.length}.`:""}`,figures:[Math.max(...n.map(({most:c})=>c))>jf?{title:`Test ratio, up to ${jf}`,unit:"1",t:r,series:o,lines:a,digits:2,range:[0,jf]}:{title:"Test ratio",unit:"1",t:r,series:o,lines:a,zero:!0,digits:2}]}}function LE(i){let t=i.channel("steps.time");if(!t)return null;let e={total:"whole step",estimator:"estimation",planner:"planning"},n=$e(t,t.t).map((r,o)=>({label:e[t.columns[o]]??t.columns[o],values:r,color:jn[(o+7)%jn.length],width:o?1:1.5})),s=[{value:1e3*i.meta.control_period,label:"control period"}];return{title:"Compute time",figures:[{title:"Control step, and its parts (wall time)",unit:"ms",t:t.t,series:n,lines:s,zero:!0,digits:1}]}}function DE(i){return{title:"Links",note:"From the telemetry log.",figures:[["link.loss","Messages lost, vehicle to ground","%",1],["link.latency","Latency, vehicle to ground (above the least)","ms",1],["link.rate","Messages received","1/s",0]].filter(([n])=>i.has(n)).map(([n,s,r,o])=>{let a=i.channel(n),l=$e(a,a.t).map((c,h)=>({label:a.columns[h],values:c,color:jn[h%jn.length]}));return{title:s,unit:r,t:a.t,series:l,zero:!0,digits:o}})}}var f0=170,UE=[{kind:"phase",label:"phase (every second one)",color:"band-phase"},{kind:"fault",label:"fault",color:"band-fault"},{kind:"mode",label:"onboard mode or failsafe",color:"band-mode"},{kind:"isolation",label:"channel isolated",color:"band-isolation"},{kind:"alarm",label:"alarm",color:"bad"}],lc=class{constructor(t,e,n,s){this.run=e,this.clock=n,this.ghost=s,this.shown=[],this.zooming=!1,this.legendAt=-1/0,this.observer=new IntersectionObserver(o=>{for(let a of o){let l=this.shown.find(({plot:c})=>c.root.parentElement===a.target);l&&(l.visible=a.isIntersecting,l.visible&&l.isOld?this.fill(l):l.visible&&this.place(l,!0))}}),this.groups=Qf(e,s),this.element=t,this.draw(),n.onChange(()=>this.move()),this.sizes=new ResizeObserver(()=>this.resize()),this.sizes.observe(t),this.closing=new AbortController,window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change",()=>this.draw(),{signal:this.closing.signal})}refresh(){this.groups=Qf(this.run,this.ghost);let t=this.groups.flatMap(s=>s.figures),e=new Set(this.run.events.map(({kind:s})=>s)),n=s=>[s.title,...s.series.map(({label:r})=>r)].join();if(e.size!==this.kinds.size||t.map(n).join()!==this.shown.map(({figure:s})=>n(s)).join()){this.draw();return}this.shown.forEach((s,r)=>{s.figure=t[r],s.visible?this.fill(s):s.isOld=!0})}fill(t){t.isOld=!1,t.plot.setData(d0(t.figure)),this.place(t,!0)}dispose(){this.observer.disconnect(),this.sizes.disconnect(),this.closing.abort();for(let{plot:t}of this.shown)t.destroy();this.shown=[]}draw(){this.observer.disconnect();for(let{plot:s}of this.shown)s.destroy();this.shown=[],this.kinds=new Set(this.run.events.map(s=>s.kind));let t=[...this.element.querySelectorAll("details:not([open]) > summary")].map(s=>s.textContent),e=UE.filter(({kind:s})=>this.kinds.has(s)).map(({kind:s,label:r})=>O("span.key",{},O(`span.swatch.${s}`,{}),r)),n=O("button",{type:"button",onclick:()=>this.zoom(this.clock.begin,this.clock.end)},"whole flight");this.element.replaceChildren(O("h2",{},"Plots"),O("p.hint",{},"Drag over a plot to zoom all of them; click to move the clock. ",n),O("p.keys-of-bands",{},...e));for(let{title:s,note:r,figures:o}of this.groups){let a=O("div.plots",{});this.element.append(O("details",{open:!t.includes(s)},O("summary",{},s),r?O("p.hint",{},r):null,a));for(let l of o)this.add(a,l)}}add(t,e){let n=O("figure",{},O("figcaption",{},e.title,...this.shadedKeys(e)));t.append(n);let s=e.lines??[],r=bn("limit"),o="12px system-ui, sans-serif",a={stroke:bn("muted"),font:o,grid:{stroke:bn("line"),width:.5},ticks:{stroke:bn("line"),width:.5}},l=e.digits??2,c={width:this.width(),height:f0,scales:{x:{time:!1,range:this.rangeX()},y:{range:(d,m,_)=>NE(e,m,_)}},cursor:{sync:{key:"report",scales:["x",null],setSeries:!1},drag:{x:!0,y:!1,setScale:!1},points:{size:6}},legend:{live:!0},padding:[12,8,0,0],axes:[{...a,label:"time (s)",labelSize:16,labelFont:o,size:28,space:60},{...a,label:e.unit==="1"?"ratio":e.unit,labelSize:16,labelFont:o,size:46}],series:[{label:"time",value:(d,m)=>m===null?"":`${m.toFixed(2)} s`},...e.series.map(({label:d,color:m,dash:_,width:g})=>({label:d,stroke:bn(m),width:g??1.5,dash:_,points:{show:!1},value:(p,S)=>S===null?"–":`${S.toFixed(l)} ${e.unit==="1"?"":e.unit}`})),...s.map(({label:d,value:m})=>({label:d?`${d} ${m} ${e.unit==="1"?"":e.unit}`:" ",stroke:r,width:1.5,dash:[7,4],points:{show:!1},value:()=>"",class:d?"line":"unnamed"}))],bands:(e.bands??[]).map(({low:d,high:m,color:_})=>({series:[m,d],fill:`${bn(_)}40`})),hooks:{setScale:[(d,m)=>{let _=m==="x"&&this.shown.find(({plot:g})=>g===d);_&&this.place(_,!0)}],drawClear:[d=>this.background(d,this.shown.find(({plot:m})=>m===d)?.figure??e)],setSelect:[d=>{d.select.width>3&&this.zoom(d.posToVal(d.select.left,"x"),d.posToVal(d.select.left+d.select.width,"x")),d.setSelect({left:0,top:0,width:0,height:0},!1)}]}},h=new xn(c,d0(e),n),f=O("div.clock-cursor",{});h.over.append(f),h.over.addEventListener("click",d=>{d.detail===1&&this.clock.set(h.posToVal(d.offsetX,"x"))}),h.over.addEventListener("dblclick",()=>this.zoom(this.clock.begin,this.clock.end));let u={plot:h,figure:e,cursor:f,visible:!1,isOld:!1};this.shown.push(u),this.observer.observe(n)}shadedKeys(t){return(t.shaded??[]).filter(({spans:e})=>e.length).map(({color:e,label:n})=>O("span.key",{},O("span.swatch",{style:{background:bn(e),opacity:"0.35"}}),n))}rangeX(){return()=>this.view??[this.clock.begin,this.clock.end]}zoom(t,e){let n=[Math.max(t,this.clock.begin),Math.min(e,this.clock.end)];this.view=n[0]>this.clock.begin||n[1]<this.clock.end?n:null;for(let{plot:s}of this.shown)s.setScale("x",{min:n[0],max:n[1]})}background(t,e){let{ctx:n}=t,{left:s,top:r,width:o,height:a}=t.bbox,l=u=>Math.min(Math.max(t.valToPos(u,"x",!0),s),s+o),c=(u,d,m,_,g)=>{let[p,S]=[l(u),l(d)];S<=s||p>=s+o||(n.fillStyle=m,n.fillRect(p,_,Math.max(S-p,1),g))};n.save();let h=this.clock.end;this.run.events.filter(u=>u.kind==="phase").forEach((u,d)=>{d%2&&c(u.start,u.end??h,bn("band-phase"),r,a)});for(let{spans:u,color:d}of e.shaded??[]){n.globalAlpha=.2;for(let[m,_]of u)c(m,_,bn(d),r,a);n.globalAlpha=1}let f=4*devicePixelRatio;for(let u of this.run.events)u.kind==="fault"?c(u.start,u.end??h,bn("band-fault"),r,a):u.kind==="mode"?c(u.start,u.end??h,bn("band-mode"),r,f):u.kind==="isolation"?c(u.start,u.end??h,bn("band-isolation"),r+f,f):u.kind==="alarm"&&c(u.start,u.start,bn("bad"),r,2*f);n.restore()}move(){let t=performance.now(),e=!this.clock.playing||t-this.legendAt>100;e&&(this.legendAt=t);for(let n of this.shown)n.visible&&this.place(n,e)}place({plot:t,figure:e,cursor:n},s){let r=t.valToPos(this.clock.time,"x"),o=r>=-.5&&r<=t.over.clientWidth+.5;n.style.display=o?"":"none",n.style.transform=`translateX(${r}px)`,s&&(t.cursor.left??-10)<0&&t.setLegend({idx:FE(e.t,this.clock.time)},!1)}width(){return Math.max(this.element.clientWidth,200)}resize(){let t=this.width();for(let e of this.shown)e.plot.width!==t&&e.plot.setSize({width:t,height:f0}),this.place(e,!1)}};function d0({t:i,series:t,lines:e=[]}){return[Array.from(i),...t.map(({values:n})=>n),...e.map(({value:n})=>Array.from(i,()=>n))]}function NE(i,t,e){if(i.range)return[i.range[0]??t,i.range[1]??e];if(t===null||e===null)return[0,1];let[n,s]=i.zero?[Math.min(t,0),Math.max(e,0)]:[t,e],r=(s-n||Math.abs(s)||1)*.06;return[i.zero&&n===0?0:n-r,s+2*r]}function FE(i,t){let[e,n]=[0,i.length-1];for(;n-e>1;){let s=e+n>>1;i[s]<=t?e=s:n=s}return t-i[e]<i[n]-t?e:n}var p0={type:"change"},ed={type:"start"},g0={type:"end"},cc=new nr,m0=new Yn,OE=Math.cos(70*Vl.DEG2RAD),hn=new D,Hn=2*Math.PI,Ue={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},td=1e-6,sa=class extends Bl{constructor(t,e=null){super(t,e),this.state=Ue.NONE,this.enabled=!0,this.target=new D,this.cursor=new D,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:wi.ROTATE,MIDDLE:wi.DOLLY,RIGHT:wi.PAN},this.touches={ONE:Gi.ROTATE,TWO:Gi.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._domElementKeyEvents=null,this._lastPosition=new D,this._lastQuaternion=new kn,this._lastTargetPosition=new D,this._quat=new kn().setFromUnitVectors(t.up,new D(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new ar,this._sphericalDelta=new ar,this._scale=1,this._panOffset=new D,this._rotateStart=new gt,this._rotateEnd=new gt,this._rotateDelta=new gt,this._panStart=new gt,this._panEnd=new gt,this._panDelta=new gt,this._dollyStart=new gt,this._dollyEnd=new gt,this._dollyDelta=new gt,this._dollyDirection=new D,this._mouse=new gt,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=zE.bind(this),this._onPointerDown=BE.bind(this),this._onPointerUp=kE.bind(this),this._onContextMenu=YE.bind(this),this._onMouseWheel=GE.bind(this),this._onKeyDown=WE.bind(this),this._onTouchStart=XE.bind(this),this._onTouchMove=qE.bind(this),this._onMouseDown=VE.bind(this),this._onMouseMove=HE.bind(this),this._interceptControlDown=$E.bind(this),this._interceptControlUp=ZE.bind(this),this.domElement!==null&&this.connect(),this.update()}connect(){this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.getRootNode().addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.removeEventListener("pointermove",this._onPointerMove),this.domElement.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.getRootNode().removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.style.touchAction="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(t){t.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=t}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(p0),this.update(),this.state=Ue.NONE}update(t=null){let e=this.object.position;hn.copy(e).sub(this.target),hn.applyQuaternion(this._quat),this._spherical.setFromVector3(hn),this.autoRotate&&this.state===Ue.NONE&&this._rotateLeft(this._getAutoRotationAngle(t)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let n=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(n)&&isFinite(s)&&(n<-Math.PI?n+=Hn:n>Math.PI&&(n-=Hn),s<-Math.PI?s+=Hn:s>Math.PI&&(s-=Hn),n<=s?this._spherical.theta=Math.max(n,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(n+s)/2?Math.max(n,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(hn.setFromSpherical(this._spherical),hn.applyQuaternion(this._quatInverse),e.copy(this.target).add(hn),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=hn.length();o=this._clampDistance(a*this._scale);let l=a-o;this.object.position.addScaledVector(this._dollyDirection,l),this.object.updateMatrixWorld(),r=!!l}else if(this.object.isOrthographicCamera){let a=new D(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let l=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=l!==this.object.zoom;let c=new D(this._mouse.x,this._mouse.y,0);c.unproject(this.object),this.object.position.sub(c).add(a),this.object.updateMatrixWorld(),o=hn.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):(cc.origin.copy(this.object.position),cc.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot(cc.direction))<OE?this.object.lookAt(this.target):(m0.setFromNormalAndCoplanarPoint(this.object.up,this.target),cc.intersectPlane(m0,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>td||8*(1-this._lastQuaternion.dot(this.object.quaternion))>td||this._lastTargetPosition.distanceToSquared(this.target)>td?(this.dispatchEvent(p0),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(t){return t!==null?Hn/60*this.autoRotateSpeed*t:Hn/60/60*this.autoRotateSpeed}_getZoomScale(t){let e=Math.abs(t*.01);return Math.pow(.95,this.zoomSpeed*e)}_rotateLeft(t){this._sphericalDelta.theta-=t}_rotateUp(t){this._sphericalDelta.phi-=t}_panLeft(t,e){hn.setFromMatrixColumn(e,0),hn.multiplyScalar(-t),this._panOffset.add(hn)}_panUp(t,e){this.screenSpacePanning===!0?hn.setFromMatrixColumn(e,1):(hn.setFromMatrixColumn(e,0),hn.crossVectors(this.object.up,hn)),hn.multiplyScalar(t),this._panOffset.add(hn)}_pan(t,e){let n=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;hn.copy(s).sub(this.target);let r=hn.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*t*r/n.clientHeight,this.object.matrix),this._panUp(2*e*r/n.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(t*(this.object.right-this.object.left)/this.object.zoom/n.clientWidth,this.object.matrix),this._panUp(e*(this.object.top-this.object.bottom)/this.object.zoom/n.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(t,e){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let n=this.domElement.getBoundingClientRect(),s=t-n.left,r=e-n.top,o=n.width,a=n.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(t){return Math.max(this.minDistance,Math.min(this.maxDistance,t))}_handleMouseDownRotate(t){this._rotateStart.set(t.clientX,t.clientY)}_handleMouseDownDolly(t){this._updateZoomParameters(t.clientX,t.clientX),this._dollyStart.set(t.clientX,t.clientY)}_handleMouseDownPan(t){this._panStart.set(t.clientX,t.clientY)}_handleMouseMoveRotate(t){this._rotateEnd.set(t.clientX,t.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(Hn*this._rotateDelta.x/e.clientHeight),this._rotateUp(Hn*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(t){this._dollyEnd.set(t.clientX,t.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.update()}_handleMouseMovePan(t){this._panEnd.set(t.clientX,t.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(t){this._updateZoomParameters(t.clientX,t.clientY),t.deltaY<0?this._dollyIn(this._getZoomScale(t.deltaY)):t.deltaY>0&&this._dollyOut(this._getZoomScale(t.deltaY)),this.update()}_handleKeyDown(t){let e=!1;switch(t.code){case this.keys.UP:t.ctrlKey||t.metaKey||t.shiftKey?this._rotateUp(Hn*this.rotateSpeed/this.domElement.clientHeight):this._pan(0,this.keyPanSpeed),e=!0;break;case this.keys.BOTTOM:t.ctrlKey||t.metaKey||t.shiftKey?this._rotateUp(-Hn*this.rotateSpeed/this.domElement.clientHeight):this._pan(0,-this.keyPanSpeed),e=!0;break;case this.keys.LEFT:t.ctrlKey||t.metaKey||t.shiftKey?this._rotateLeft(Hn*this.rotateSpeed/this.domElement.clientHeight):this._pan(this.keyPanSpeed,0),e=!0;break;case this.keys.RIGHT:t.ctrlKey||t.metaKey||t.shiftKey?this._rotateLeft(-Hn*this.rotateSpeed/this.domElement.clientHeight):this._pan(-this.keyPanSpeed,0),e=!0;break}e&&(t.preventDefault(),this.update())}_handleTouchStartRotate(t){if(this._pointers.length===1)this._rotateStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._rotateStart.set(n,s)}}_handleTouchStartPan(t){if(this._pointers.length===1)this._panStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panStart.set(n,s)}}_handleTouchStartDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enablePan&&this._handleTouchStartPan(t)}_handleTouchStartDollyRotate(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enableRotate&&this._handleTouchStartRotate(t)}_handleTouchMoveRotate(t){if(this._pointers.length==1)this._rotateEnd.set(t.pageX,t.pageY);else{let n=this._getSecondPointerPosition(t),s=.5*(t.pageX+n.x),r=.5*(t.pageY+n.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(Hn*this._rotateDelta.x/e.clientHeight),this._rotateUp(Hn*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(t){if(this._pointers.length===1)this._panEnd.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panEnd.set(n,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(t.pageX+e.x)*.5,a=(t.pageY+e.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enablePan&&this._handleTouchMovePan(t)}_handleTouchMoveDollyRotate(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enableRotate&&this._handleTouchMoveRotate(t)}_addPointer(t){this._pointers.push(t.pointerId)}_removePointer(t){delete this._pointerPositions[t.pointerId];for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId){this._pointers.splice(e,1);return}}_isTrackingPointer(t){for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId)return!0;return!1}_trackPointer(t){let e=this._pointerPositions[t.pointerId];e===void 0&&(e=new gt,this._pointerPositions[t.pointerId]=e),e.set(t.pageX,t.pageY)}_getSecondPointerPosition(t){let e=t.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[e]}_customWheelEvent(t){let e=t.deltaMode,n={clientX:t.clientX,clientY:t.clientY,deltaY:t.deltaY};switch(e){case 1:n.deltaY*=16;break;case 2:n.deltaY*=100;break}return t.ctrlKey&&!this._controlActive&&(n.deltaY*=10),n}};function BE(i){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(i.pointerId),this.domElement.addEventListener("pointermove",this._onPointerMove),this.domElement.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(i)&&(this._addPointer(i),i.pointerType==="touch"?this._onTouchStart(i):this._onMouseDown(i)))}function zE(i){this.enabled!==!1&&(i.pointerType==="touch"?this._onTouchMove(i):this._onMouseMove(i))}function kE(i){switch(this._removePointer(i),this._pointers.length){case 0:this.domElement.releasePointerCapture(i.pointerId),this.domElement.removeEventListener("pointermove",this._onPointerMove),this.domElement.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(g0),this.state=Ue.NONE;break;case 1:let t=this._pointers[0],e=this._pointerPositions[t];this._onTouchStart({pointerId:t,pageX:e.x,pageY:e.y});break}}function VE(i){let t;switch(i.button){case 0:t=this.mouseButtons.LEFT;break;case 1:t=this.mouseButtons.MIDDLE;break;case 2:t=this.mouseButtons.RIGHT;break;default:t=-1}switch(t){case wi.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(i),this.state=Ue.DOLLY;break;case wi.ROTATE:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=Ue.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=Ue.ROTATE}break;case wi.PAN:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=Ue.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=Ue.PAN}break;default:this.state=Ue.NONE}this.state!==Ue.NONE&&this.dispatchEvent(ed)}function HE(i){switch(this.state){case Ue.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(i);break;case Ue.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(i);break;case Ue.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(i);break}}function GE(i){this.enabled===!1||this.enableZoom===!1||this.state!==Ue.NONE||(i.preventDefault(),this.dispatchEvent(ed),this._handleMouseWheel(this._customWheelEvent(i)),this.dispatchEvent(g0))}function WE(i){this.enabled===!1||this.enablePan===!1||this._handleKeyDown(i)}function XE(i){switch(this._trackPointer(i),this._pointers.length){case 1:switch(this.touches.ONE){case Gi.ROTATE:if(this.enableRotate===!1)return;this._handleTouchStartRotate(i),this.state=Ue.TOUCH_ROTATE;break;case Gi.PAN:if(this.enablePan===!1)return;this._handleTouchStartPan(i),this.state=Ue.TOUCH_PAN;break;default:this.state=Ue.NONE}break;case 2:switch(this.touches.TWO){case Gi.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(i),this.state=Ue.TOUCH_DOLLY_PAN;break;case Gi.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(i),this.state=Ue.TOUCH_DOLLY_ROTATE;break;default:this.state=Ue.NONE}break;default:this.state=Ue.NONE}this.state!==Ue.NONE&&this.dispatchEvent(ed)}function qE(i){switch(this._trackPointer(i),this.state){case Ue.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(i),this.update();break;case Ue.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(i),this.update();break;case Ue.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(i),this.update();break;case Ue.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(i),this.update();break;default:this.state=Ue.NONE}}function YE(i){this.enabled!==!1&&i.preventDefault()}function $E(i){i.key==="Control"&&(this._controlActive=!0,this.domElement.getRootNode().addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function ZE(i){i.key==="Control"&&(this._controlActive=!1,this.domElement.getRootNode().removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var _0=40,x0=new D(-.45,.5,1).normalize(),nd=Math.PI/36,JE=.94,hc=class{constructor(t,e,n,s,r){let o=ce(e.low),a=ce(e.high);this.corners=[0,1,2,3,4,5,6,7].map(l=>new D(l&1?o.x:a.x,l&2?o.y:a.y,l&4?o.z:a.z)),this.middle=o.clone().add(a).multiplyScalar(.5),this.formation=n,this.perspective=new Un(_0,1,.1,5e3),this.above=new eo(-1,1,1,-1,.1,5e3),this.above.up.set(0,0,-1),this.orbit=new sa(this.perspective,t),this.orbit.maxPolarAngle=.497*Math.PI,this.orbit.minDistance=1,this.orbit.zoomToCursor=!1,this.pan=new sa(this.above,t),this.pan.enableRotate=!1,this.pan.mouseButtons={LEFT:wi.PAN,MIDDLE:wi.DOLLY,RIGHT:wi.PAN},this.pan.touches={ONE:Gi.PAN,TWO:Gi.DOLLY_PAN},this.followed=new D,this.aside=s,this.seen=1,this.kind="free",this.isPlaced=!1;for(let l of[this.orbit,this.pan])l.enableDamping=!1,l.addEventListener("change",r)}get current(){return this.kind==="top"?this.above:this.perspective}resize(t,e,n){this.seen=1-n/t,this.perspective.aspect=t/e;for(let s of[this.perspective,this.above])s.setViewOffset(t,e,n/2,0,t,e);this.frameAbove(t/e),this.isPlaced||this.set(this.kind),this.isPlaced=!0}set(t){this.kind=t,this.orbit.enabled=t!=="top",this.pan.enabled=t==="top",t==="free"?this.frame(this.corners,x0):t==="follow"?this.nearby():(this.pan.target.copy(this.middle),this.above.position.copy(this.middle).setY(1e3),this.above.zoom=1,this.above.updateProjectionMatrix(),this.pan.update())}frame(t,e){let{perspective:n}=this,{target:s}=this.orbit;s.copy(t[0]).add(t[7]).multiplyScalar(.5),n.position.copy(s).add(e),n.lookAt(s),n.updateMatrixWorld();let[r,o,a]=[0,1,2].map(h=>new D().setFromMatrixColumn(n.matrixWorld,h)),l=JE*Math.tan(_0*Math.PI/360),c=0;for(let h=0;h<4;h+=1){let f=t.map(d=>d.clone().sub(s)),u=d=>Math.max(Math.abs(d.dot(r))/(n.aspect*this.seen),Math.abs(d.dot(o)));c=Math.max(...f.map(d=>d.dot(a)+u(d)/l));for(let d of[r,o]){let m=f.map(_=>_.dot(d)/(c-_.dot(a)));s.addScaledVector(d,c*(Math.min(...m)+Math.max(...m))/2)}}n.position.copy(s).addScaledVector(e,c),this.orbit.update()}nearby(){this.orbit.target.copy(this.followed);let t=2.1*this.formation/Math.min(1,1.2*this.perspective.aspect*this.seen);this.perspective.position.copy(this.followed).addScaledVector(this.aside,t),this.orbit.update()}follow(t){let e=t.clone();e.y+=.25*this.formation,this.kind==="follow"&&(this.perspective.position.add(e).sub(this.followed),this.orbit.target.copy(e),this.orbit.update()),this.followed.copy(e)}resume(t){if(this.set(t.kind),t.kind!=="follow")return;let e=t.perspective.position.clone().sub(t.orbit.target);this.perspective.position.copy(this.orbit.target).add(e),this.orbit.update()}frameAbove(t){let e=1.1*Math.abs(this.corners[0].x-this.corners[1].x),n=1.1*Math.abs(this.corners[0].z-this.corners[4].z),s=Math.max(n,e/(t*this.seen))/2+.5;Object.assign(this.above,{left:-s*t,right:s*t,top:s,bottom:-s}),this.above.updateProjectionMatrix()}from(t){return this.kind==="top"?t.set(0,1,0):t.copy(this.perspective.position).sub(this.orbit.target).normalize()}eye(t){return this.kind==="top"?t.clone().setY(1e3):this.perspective.position}zoom(t){if(this.kind==="top")this.above.zoom/=t,this.above.updateProjectionMatrix(),this.pan.update();else{let{target:e}=this.orbit;this.perspective.position.sub(e).multiplyScalar(t).add(e),this.orbit.update()}}turn(t,e){let{orbit:n,pan:s}=this;if(this.kind==="top"){let a=.05*(this.above.top-this.above.bottom)/this.above.zoom;for(let l of[s.target,this.above.position])l.add(new D(t*a,0,-e*a));s.update();return}let r=this.perspective.position.clone().sub(n.target),o=new ar().setFromVector3(r);o.theta+=t*nd,o.phi=Math.min(Math.max(o.phi-e*nd,nd),n.maxPolarAngle),this.perspective.position.setFromSpherical(o).add(n.target),n.update()}dispose(){this.orbit.dispose(),this.pan.dispose()}};function y0(i,t,e){let{clearance:n}=i,s=x0.clone().setY(0);if(n&&n.min>0){let c=ce(n.point_obstacle).sub(ce(n.point_hull));Math.hypot(c.x,c.z)>.2*n.min&&s.set(-c.z,0,c.x),s.z<0&&s.negate()}s.normalize();let r=[.3,.7,1.2].flatMap(c=>[1,-1].map(h=>new D(h*s.x,c,h*s.z).normalize()));if(!n)return r[0];let o=i.flown("position").at(n.time),a=[n.point_hull,n.point_obstacle,o].map(c=>ce(c)),l=c=>a.every(h=>t.hiding(h.clone().addScaledVector(c,e),h).length===0);return r.find(l)??r[0]}var v0=new Vn,uc=new D,yo=class extends Fl{constructor(){super(),this.isLineSegmentsGeometry=!0,this.type="LineSegmentsGeometry";let t=[-1,2,0,1,2,0,-1,1,0,1,1,0,-1,0,0,1,0,0,-1,-1,0,1,-1,0],e=[-1,2,1,2,-1,1,1,1,-1,-1,1,-1,-1,-2,1,-2],n=[0,2,1,2,3,1,2,4,3,4,5,3,4,6,5,6,7,5];this.setIndex(n),this.setAttribute("position",new Qt(t,3)),this.setAttribute("uv",new Qt(e,2))}applyMatrix4(t){let e=this.attributes.instanceStart,n=this.attributes.instanceEnd;return e!==void 0&&(e.applyMatrix4(t),n.applyMatrix4(t),e.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this}setPositions(t){let e;t instanceof Float32Array?e=t:Array.isArray(t)&&(e=new Float32Array(t));let n=new or(e,6,1);return this.setAttribute("instanceStart",new Hi(n,3,0)),this.setAttribute("instanceEnd",new Hi(n,3,3)),this.instanceCount=this.attributes.instanceStart.count,this.computeBoundingBox(),this.computeBoundingSphere(),this}setColors(t){let e;t instanceof Float32Array?e=t:Array.isArray(t)&&(e=new Float32Array(t));let n=new or(e,6,1);return this.setAttribute("instanceColorStart",new Hi(n,3,0)),this.setAttribute("instanceColorEnd",new Hi(n,3,3)),this}fromWireframeGeometry(t){return this.setPositions(t.attributes.position.array),this}fromEdgesGeometry(t){return this.setPositions(t.attributes.position.array),this}fromMesh(t){return this.fromWireframeGeometry(new Pl(t.geometry)),this}fromLineSegments(t){let e=t.geometry;return this.setPositions(e.attributes.position.array),this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new Vn);let t=this.attributes.instanceStart,e=this.attributes.instanceEnd;t!==void 0&&e!==void 0&&(this.boundingBox.setFromBufferAttribute(t),v0.setFromBufferAttribute(e),this.boundingBox.union(v0))}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new zi),this.boundingBox===null&&this.computeBoundingBox();let t=this.attributes.instanceStart,e=this.attributes.instanceEnd;if(t!==void 0&&e!==void 0){let n=this.boundingSphere.center;this.boundingBox.getCenter(n);let s=0;for(let r=0,o=t.count;r<o;r++)uc.fromBufferAttribute(t,r),s=Math.max(s,n.distanceToSquared(uc)),uc.fromBufferAttribute(e,r),s=Math.max(s,n.distanceToSquared(uc));this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&console.error("THREE.LineSegmentsGeometry.computeBoundingSphere(): Computed radius is NaN. The instanced position data is likely to have NaN values.",this)}}toJSON(){}applyMatrix(t){return console.warn("THREE.LineSegmentsGeometry: applyMatrix() has been renamed to applyMatrix4()."),this.applyMatrix4(t)}};bt.line={worldUnits:{value:1},linewidth:{value:1},resolution:{value:new gt(1,1)},dashOffset:{value:0},dashScale:{value:1},dashSize:{value:1},gapSize:{value:1}};Nn.line={uniforms:Hl.merge([bt.common,bt.fog,bt.line]),vertexShader:`
		#include <common>
		#include <color_pars_vertex>
		#include <fog_pars_vertex>
		#include <logdepthbuf_pars_vertex>
		#include <clipping_planes_pars_vertex>

		uniform float linewidth;
		uniform vec2 resolution;

		attribute vec3 instanceStart;
		attribute vec3 instanceEnd;

		attribute vec3 instanceColorStart;
		attribute vec3 instanceColorEnd;

		#ifdef WORLD_UNITS

			varying vec4 worldPos;
			varying vec3 worldStart;
			varying vec3 worldEnd;

			#ifdef USE_DASH

				varying vec2 vUv;

			#endif

		#else

			varying vec2 vUv;

		#endif

		#ifdef USE_DASH

			uniform float dashScale;
			attribute float instanceDistanceStart;
			attribute float instanceDistanceEnd;
			varying float vLineDistance;

		#endif

		void trimSegment( const in vec4 start, inout vec4 end ) {

			// trim end segment so it terminates between the camera plane and the near plane

			// conservative estimate of the near plane
			float a = projectionMatrix[ 2 ][ 2 ]; // 3nd entry in 3th column
			float b = projectionMatrix[ 3 ][ 2 ]; // 3nd entry in 4th column
			float nearEstimate = - 0.5 * b / a;

			float alpha = ( nearEstimate - start.z ) / ( end.z - start.z );

			end.xyz = mix( start.xyz, end.xyz, alpha );

		}

		void main() {

			#ifdef USE_COLOR

				vColor.xyz = ( position.y < 0.5 ) ? instanceColorStart : instanceColorEnd;

			#endif

			#ifdef USE_DASH

				vLineDistance = ( position.y < 0.5 ) ? dashScale * instanceDistanceStart : dashScale * instanceDistanceEnd;
				vUv = uv;

			#endif

			float aspect = resolution.x / resolution.y;

			// camera space
			vec4 start = modelViewMatrix * vec4( instanceStart, 1.0 );
			vec4 end = modelViewMatrix * vec4( instanceEnd, 1.0 );

			#ifdef WORLD_UNITS

				worldStart = start.xyz;
				worldEnd = end.xyz;

			#else

				vUv = uv;

			#endif

			// special case for perspective projection, and segments that terminate either in, or behind, the camera plane
			// clearly the gpu firmware has a way of addressing this issue when projecting into ndc space
			// but we need to perform ndc-space calculations in the shader, so we must address this issue directly
			// perhaps there is a more elegant solution -- WestLangley

			bool perspective = ( projectionMatrix[ 2 ][ 3 ] == - 1.0 ); // 4th entry in the 3rd column

			if ( perspective ) {

				if ( start.z < 0.0 && end.z >= 0.0 ) {

					trimSegment( start, end );

				} else if ( end.z < 0.0 && start.z >= 0.0 ) {

					trimSegment( end, start );

				}

			}

			// clip space
			vec4 clipStart = projectionMatrix * start;
			vec4 clipEnd = projectionMatrix * end;

			// ndc space
			vec3 ndcStart = clipStart.xyz / clipStart.w;
			vec3 ndcEnd = clipEnd.xyz / clipEnd.w;

			// direction
			vec2 dir = ndcEnd.xy - ndcStart.xy;

			// account for clip-space aspect ratio
			dir.x *= aspect;
			dir = normalize( dir );

			#ifdef WORLD_UNITS

				vec3 worldDir = normalize( end.xyz - start.xyz );
				vec3 tmpFwd = normalize( mix( start.xyz, end.xyz, 0.5 ) );
				vec3 worldUp = normalize( cross( worldDir, tmpFwd ) );
				vec3 worldFwd = cross( worldDir, worldUp );
				worldPos = position.y < 0.5 ? start: end;

				// height offset
				float hw = linewidth * 0.5;
				worldPos.xyz += position.x < 0.0 ? hw * worldUp : - hw * worldUp;

				// don't extend the line if we're rendering dashes because we
				// won't be rendering the endcaps
				#ifndef USE_DASH

					// cap extension
					worldPos.xyz += position.y < 0.5 ? - hw * worldDir : hw * worldDir;

					// add width to the box
					worldPos.xyz += worldFwd * hw;

					// endcaps
					if ( position.y > 1.0 || position.y < 0.0 ) {

						worldPos.xyz -= worldFwd * 2.0 * hw;

					}

				#endif

				// project the worldpos
				vec4 clip = projectionMatrix * worldPos;

				// shift the depth of the projected points so the line
				// segments overlap neatly
				vec3 clipPose = ( position.y < 0.5 ) ? ndcStart : ndcEnd;
				clip.z = clipPose.z * clip.w;

			#else

				vec2 offset = vec2( dir.y, - dir.x );
				// undo aspect ratio adjustment
				dir.x /= aspect;
				offset.x /= aspect;

				// sign flip
				if ( position.x < 0.0 ) offset *= - 1.0;

				// endcaps
				if ( position.y < 0.0 ) {

					offset += - dir;

				} else if ( position.y > 1.0 ) {

					offset += dir;

				}

				// adjust for linewidth
				offset *= linewidth;

				// adjust for clip-space to screen-space conversion // maybe resolution should be based on viewport ...
				offset /= resolution.y;

				// select end
				vec4 clip = ( position.y < 0.5 ) ? clipStart : clipEnd;

				// back to clip space
				offset *= clip.w;

				clip.xy += offset;

			#endif

			gl_Position = clip;

			vec4 mvPosition = ( position.y < 0.5 ) ? start : end; // this is an approximation

			#include <logdepthbuf_vertex>
			#include <clipping_planes_vertex>
			#include <fog_vertex>

		}
		`,fragmentShader:`
		uniform vec3 diffuse;
		uniform float opacity;
		uniform float linewidth;

		#ifdef USE_DASH

			uniform float dashOffset;
			uniform float dashSize;
			uniform float gapSize;

		#endif

		varying float vLineDistance;

		#ifdef WORLD_UNITS

			varying vec4 worldPos;
			varying vec3 worldStart;
			varying vec3 worldEnd;

			#ifdef USE_DASH

				varying vec2 vUv;

			#endif

		#else

			varying vec2 vUv;

		#endif

		#include <common>
		#include <color_pars_fragment>
		#include <fog_pars_fragment>
		#include <logdepthbuf_pars_fragment>
		#include <clipping_planes_pars_fragment>

		vec2 closestLineToLine(vec3 p1, vec3 p2, vec3 p3, vec3 p4) {

			float mua;
			float mub;

			vec3 p13 = p1 - p3;
			vec3 p43 = p4 - p3;

			vec3 p21 = p2 - p1;

			float d1343 = dot( p13, p43 );
			float d4321 = dot( p43, p21 );
			float d1321 = dot( p13, p21 );
			float d4343 = dot( p43, p43 );
			float d2121 = dot( p21, p21 );

			float denom = d2121 * d4343 - d4321 * d4321;

			float numer = d1343 * d4321 - d1321 * d4343;

			mua = numer / denom;
			mua = clamp( mua, 0.0, 1.0 );
			mub = ( d1343 + d4321 * ( mua ) ) / d4343;
			mub = clamp( mub, 0.0, 1.0 );

			return vec2( mua, mub );

		}

		void main() {

			#include <clipping_planes_fragment>

			#ifdef USE_DASH

				if ( vUv.y < - 1.0 || vUv.y > 1.0 ) discard; // discard endcaps

				if ( mod( vLineDistance + dashOffset, dashSize + gapSize ) > dashSize ) discard; // todo - FIX

			#endif

			float alpha = opacity;

			#ifdef WORLD_UNITS

				// Find the closest points on the view ray and the line segment
				vec3 rayEnd = normalize( worldPos.xyz ) * 1e5;
				vec3 lineDir = worldEnd - worldStart;
				vec2 params = closestLineToLine( worldStart, worldEnd, vec3( 0.0, 0.0, 0.0 ), rayEnd );

				vec3 p1 = worldStart + lineDir * params.x;
				vec3 p2 = rayEnd * params.y;
				vec3 delta = p1 - p2;
				float len = length( delta );
				float norm = len / linewidth;

				#ifndef USE_DASH

					#ifdef USE_ALPHA_TO_COVERAGE

						float dnorm = fwidth( norm );
						alpha = 1.0 - smoothstep( 0.5 - dnorm, 0.5 + dnorm, norm );

					#else

						if ( norm > 0.5 ) {

							discard;

						}

					#endif

				#endif

			#else

				#ifdef USE_ALPHA_TO_COVERAGE

					// artifacts appear on some hardware if a derivative is taken within a conditional
					float a = vUv.x;
					float b = ( vUv.y > 0.0 ) ? vUv.y - 1.0 : vUv.y + 1.0;
					float len2 = a * a + b * b;
					float dlen = fwidth( len2 );

					if ( abs( vUv.y ) > 1.0 ) {

						alpha = 1.0 - smoothstep( 1.0 - dlen, 1.0 + dlen, len2 );

					}

				#else

					if ( abs( vUv.y ) > 1.0 ) {

						float a = vUv.x;
						float b = ( vUv.y > 0.0 ) ? vUv.y - 1.0 : vUv.y + 1.0;
						float len2 = a * a + b * b;

						if ( len2 > 1.0 ) discard;

					}

				#endif

			#endif

			vec4 diffuseColor = vec4( diffuse, alpha );

			#include <logdepthbuf_fragment>
			#include <color_fragment>

			gl_FragColor = vec4( diffuseColor.rgb, alpha );

			#include <tonemapping_fragment>
			#include <colorspace_fragment>
			#include <fog_fragment>
			#include <premultiplied_alpha_fragment>

		}
		`};var ms=class extends ai{static get type(){return"LineMaterial"}constructor(t){super({uniforms:Hl.clone(Nn.line.uniforms),vertexShader:Nn.line.vertexShader,fragmentShader:Nn.line.fragmentShader,clipping:!0}),this.isLineMaterial=!0,this.setValues(t)}get color(){return this.uniforms.diffuse.value}set color(t){this.uniforms.diffuse.value=t}get worldUnits(){return"WORLD_UNITS"in this.defines}set worldUnits(t){t===!0?this.defines.WORLD_UNITS="":delete this.defines.WORLD_UNITS}get linewidth(){return this.uniforms.linewidth.value}set linewidth(t){this.uniforms.linewidth&&(this.uniforms.linewidth.value=t)}get dashed(){return"USE_DASH"in this.defines}set dashed(t){t===!0!==this.dashed&&(this.needsUpdate=!0),t===!0?this.defines.USE_DASH="":delete this.defines.USE_DASH}get dashScale(){return this.uniforms.dashScale.value}set dashScale(t){this.uniforms.dashScale.value=t}get dashSize(){return this.uniforms.dashSize.value}set dashSize(t){this.uniforms.dashSize.value=t}get dashOffset(){return this.uniforms.dashOffset.value}set dashOffset(t){this.uniforms.dashOffset.value=t}get gapSize(){return this.uniforms.gapSize.value}set gapSize(t){this.uniforms.gapSize.value=t}get opacity(){return this.uniforms.opacity.value}set opacity(t){this.uniforms&&(this.uniforms.opacity.value=t)}get resolution(){return this.uniforms.resolution.value}set resolution(t){this.uniforms.resolution.value.copy(t)}get alphaToCoverage(){return"USE_ALPHA_TO_COVERAGE"in this.defines}set alphaToCoverage(t){this.defines&&(t===!0!==this.alphaToCoverage&&(this.needsUpdate=!0),t===!0?this.defines.USE_ALPHA_TO_COVERAGE="":delete this.defines.USE_ALPHA_TO_COVERAGE)}};var id=new De,M0=new D,b0=new D,yn=new De,vn=new De,Xi=new De,sd=new D,rd=new ze,Mn=new so,S0=new D,fc=new Vn,dc=new zi,qi=new De,Yi,pr;function w0(i,t,e){return qi.set(0,0,-t,1).applyMatrix4(i.projectionMatrix),qi.multiplyScalar(1/qi.w),qi.x=pr/e.width,qi.y=pr/e.height,qi.applyMatrix4(i.projectionMatrixInverse),qi.multiplyScalar(1/qi.w),Math.abs(Math.max(qi.x,qi.y))}function KE(i,t){let e=i.matrixWorld,n=i.geometry,s=n.attributes.instanceStart,r=n.attributes.instanceEnd,o=Math.min(n.instanceCount,s.count);for(let a=0,l=o;a<l;a++){Mn.start.fromBufferAttribute(s,a),Mn.end.fromBufferAttribute(r,a),Mn.applyMatrix4(e);let c=new D,h=new D;Yi.distanceSqToSegment(Mn.start,Mn.end,h,c),h.distanceTo(c)<pr*.5&&t.push({point:h,pointOnLine:c,distance:Yi.origin.distanceTo(h),object:i,face:null,faceIndex:a,uv:null,uv1:null})}}function jE(i,t,e){let n=t.projectionMatrix,r=i.material.resolution,o=i.matrixWorld,a=i.geometry,l=a.attributes.instanceStart,c=a.attributes.instanceEnd,h=Math.min(a.instanceCount,l.count),f=-t.near;Yi.at(1,Xi),Xi.w=1,Xi.applyMatrix4(t.matrixWorldInverse),Xi.applyMatrix4(n),Xi.multiplyScalar(1/Xi.w),Xi.x*=r.x/2,Xi.y*=r.y/2,Xi.z=0,sd.copy(Xi),rd.multiplyMatrices(t.matrixWorldInverse,o);for(let u=0,d=h;u<d;u++){if(yn.fromBufferAttribute(l,u),vn.fromBufferAttribute(c,u),yn.w=1,vn.w=1,yn.applyMatrix4(rd),vn.applyMatrix4(rd),yn.z>f&&vn.z>f)continue;if(yn.z>f){let v=yn.z-vn.z,y=(yn.z-f)/v;yn.lerp(vn,y)}else if(vn.z>f){let v=vn.z-yn.z,y=(vn.z-f)/v;vn.lerp(yn,y)}yn.applyMatrix4(n),vn.applyMatrix4(n),yn.multiplyScalar(1/yn.w),vn.multiplyScalar(1/vn.w),yn.x*=r.x/2,yn.y*=r.y/2,vn.x*=r.x/2,vn.y*=r.y/2,Mn.start.copy(yn),Mn.start.z=0,Mn.end.copy(vn),Mn.end.z=0;let _=Mn.closestPointToPointParameter(sd,!0);Mn.at(_,S0);let g=Vl.lerp(yn.z,vn.z,_),p=g>=-1&&g<=1,S=sd.distanceTo(S0)<pr*.5;if(p&&S){Mn.start.fromBufferAttribute(l,u),Mn.end.fromBufferAttribute(c,u),Mn.start.applyMatrix4(o),Mn.end.applyMatrix4(o);let v=new D,y=new D;Yi.distanceSqToSegment(Mn.start,Mn.end,y,v),e.push({point:y,pointOnLine:v,distance:Yi.origin.distanceTo(y),object:i,face:null,faceIndex:u,uv:null,uv1:null})}}}var pc=class extends xe{constructor(t=new yo,e=new ms({color:Math.random()*16777215})){super(t,e),this.isLineSegments2=!0,this.type="LineSegments2"}computeLineDistances(){let t=this.geometry,e=t.attributes.instanceStart,n=t.attributes.instanceEnd,s=new Float32Array(2*e.count);for(let o=0,a=0,l=e.count;o<l;o++,a+=2)M0.fromBufferAttribute(e,o),b0.fromBufferAttribute(n,o),s[a]=a===0?0:s[a-1],s[a+1]=s[a]+M0.distanceTo(b0);let r=new or(s,2,1);return t.setAttribute("instanceDistanceStart",new Hi(r,1,0)),t.setAttribute("instanceDistanceEnd",new Hi(r,1,1)),this}raycast(t,e){let n=this.material.worldUnits,s=t.camera;s===null&&!n&&console.error('LineSegments2: "Raycaster.camera" needs to be set in order to raycast against LineSegments2 while worldUnits is set to false.');let r=t.params.Line2!==void 0&&t.params.Line2.threshold||0;Yi=t.ray;let o=this.matrixWorld,a=this.geometry,l=this.material;pr=l.linewidth+r,a.boundingSphere===null&&a.computeBoundingSphere(),dc.copy(a.boundingSphere).applyMatrix4(o);let c;if(n)c=pr*.5;else{let f=Math.max(s.near,dc.distanceToPoint(Yi.origin));c=w0(s,f,l.resolution)}if(dc.radius+=c,Yi.intersectsSphere(dc)===!1)return;a.boundingBox===null&&a.computeBoundingBox(),fc.copy(a.boundingBox).applyMatrix4(o);let h;if(n)h=pr*.5;else{let f=Math.max(s.near,fc.distanceToPoint(Yi.origin));h=w0(s,f,l.resolution)}fc.expandByScalar(h),Yi.intersectsBox(fc)!==!1&&(n?KE(this,e):jE(this,s,e))}onBeforeRender(t){let e=this.material.uniforms;e&&e.resolution&&(t.getViewport(id),this.material.uniforms.resolution.value.set(id.z,id.w))}};var mc=class extends yo{constructor(){super(),this.isLineGeometry=!0,this.type="LineGeometry"}setPositions(t){let e=t.length-3,n=new Float32Array(2*e);for(let s=0;s<e;s+=3)n[2*s]=t[s],n[2*s+1]=t[s+1],n[2*s+2]=t[s+2],n[2*s+3]=t[s+3],n[2*s+4]=t[s+4],n[2*s+5]=t[s+5];return super.setPositions(n),this}setColors(t){let e=t.length-3,n=new Float32Array(2*e);for(let s=0;s<e;s+=3)n[2*s]=t[s],n[2*s+1]=t[s+1],n[2*s+2]=t[s+2],n[2*s+3]=t[s+3],n[2*s+4]=t[s+4],n[2*s+5]=t[s+5];return super.setColors(n),this}fromLine(t){let e=t.geometry;return this.setPositions(e.attributes.position.array),this}};var gc=class extends pc{constructor(t=new mc,e=new ms({color:Math.random()*16777215})){super(t,e),this.isLine2=!0,this.type="Line2"}};var E0={position:[-1,1,0,1,1,0,-1,0,0,1,0,0],uv:[-1,1,1,1,-1,-1,1,-1]},T0=[0,2,1,2,3,1],A0=4,Ci=class extends gc{constructor(t){super(new ve,t),this.frustumCulled=!1,this.visible=!1}setPoints(t,e){this.visible=t.length>1,this.visible&&(this.geometry.dispose(),this.geometry=QE(t.length-1),this.setEnds("",t.map(([n,s,r])=>[s,-r,-n])),e&&this.setEnds("Color",e.map(({r:n,g:s,b:r})=>[n,s,r])),this.material.dashed&&this.setEnds("Distance",tT(t)))}setEnds(t,e){for(let[n,s]of[["Start",0],["End",1]]){let o=e.slice(s,s+e.length-1).flatMap(a=>Array(A0).fill(a).flat());this.geometry.setAttribute(`instance${t}${n}`,new Qt(o,e[0].length))}}showFirst(t){this.geometry.setDrawRange(0,T0.length*t)}};function QE(i){let t=new ve;return t.setAttribute("position",new Qt(od(E0.position,i),3)),t.setAttribute("uv",new Qt(od(E0.uv,i),2)),t.setIndex(od(T0,i,A0))}function od(i,t,e=0){return Array.from({length:t},(n,s)=>i.map(r=>r+s*e)).flat()}function tT(i){let t=0;return i.map((e,n)=>(n>0&&(t+=Math.hypot(...[0,1,2].map(s=>e[s]-i[n-1][s]))),[t]))}var eT=1.5,_c=class{constructor(t,e,n){if(this.group=new Be,this.always=!1,this.found=t.clearance,this.ends=[],this.label=null,!this.found)return;let{min:s,obstacle:r,point_hull:o,point_obstacle:a}=this.found,l={depthTest:!1,transparent:!0},c=new Ci(e.line("clearance",3,l));c.setPoints([o,a]);let h=new no(.06,16,10),f=e.flat("clearance",l),u=[o,a].map(d=>{let m=new xe(h,f);return ce(d,m.position),m});this.group.add(c,...u);for(let d of this.group.children)d.renderOrder=10;this.label=n.add(s>0?`${s.toFixed(2)} m to ${r}`:`touched ${r}`,s>0?"clearance":"contact"),this.points=[ce(o),ce(a)],this.label.position.copy(ce(o)).add(ce(a)).multiplyScalar(.5)}update(t){let e=this.found!==null&&(this.always||Math.abs(t-this.found.time)<=eT);this.group.visible=e,this.ends=e?this.points??[]:[],this.label&&(this.label.visible=e)}};function ra({name:i}){return/^fence (circle|polygon) \d+/.test(i)}function C0(i,t,e,n){let s=new Be,{boundary:r=[],excluded:o=[]}=i.meta.fence??{},a=e.translucent("fence",.07),l=e.hairline("fence",.8);for(let d of r){let{faces:m,edges:_}=sT(d,t);s.add(new xe(m,a),new on(_,l))}let c=e.translucent("limit",.14),h=e.hairline("limit",.9),f=i.obstacles.filter(ra),u=f.filter(d=>d.kind==="pole");for(let d of[...o.map(m=>nT(m,t)),...u.map(m=>iT(m,t))])s.add(new xe(d,c),new on(new ci(d,30),h));for(let{name:d,position:[m,_]}of f){let g=n.add(d,"obstacle");g.position.set(_,t,-m),g.layer=()=>s.visible}return s}function nT(i,t){let e=new Us;return i.forEach(([n,s],r)=>r?e.lineTo(s,n):e.moveTo(s,n)),new Al(e,{depth:t,bevelEnabled:!1}).rotateX(-Math.PI/2)}function iT({position:[i,t],radius:e},n){return new fs(e,e,n,48).translate(t,n/2,-i)}function sT(i,t){let e=[],n=[];for(let r=0;r<i.length;r+=1){let[[o,a],[l,c]]=[i[r],i[(r+1)%i.length]],h=[[a,0,-o],[c,0,-l],[c,t,-l],[a,t,-o]];for(let f of[0,1,2,0,2,3])e.push(...h[f]);for(let f of[0,1,2,3,0,3])n.push(...h[f])}let s=r=>new ve().setAttribute("position",new Qt(r,3));return{faces:s(e),edges:s(n)}}var yc=0,rT=1,oT=new D,R0=new so,ad=new Yn,P0=new D,xc=new Fi,vc=class{constructor(){this.tolerance=-1,this.faces=[],this.newFaces=[],this.assigned=new Mc,this.unassigned=new Mc,this.vertices=[]}setFromPoints(t){if(t.length>=4){this.makeEmpty();for(let e=0,n=t.length;e<n;e++)this.vertices.push(new ld(t[e]));this.compute()}return this}setFromObject(t){let e=[];return t.updateMatrixWorld(!0),t.traverse(function(n){let s=n.geometry;if(s!==void 0){let r=s.attributes.position;if(r!==void 0)for(let o=0,a=r.count;o<a;o++){let l=new D;l.fromBufferAttribute(r,o).applyMatrix4(n.matrixWorld),e.push(l)}}}),this.setFromPoints(e)}containsPoint(t){let e=this.faces;for(let n=0,s=e.length;n<s;n++)if(e[n].distanceToPoint(t)>this.tolerance)return!1;return!0}intersectRay(t,e){let n=this.faces,s=-1/0,r=1/0;for(let o=0,a=n.length;o<a;o++){let l=n[o],c=l.distanceToPoint(t.origin),h=l.normal.dot(t.direction);if(c>0&&h>=0)return null;let f=h!==0?-c/h:0;if(!(f<=0)&&(h>0?r=Math.min(f,r):s=Math.max(f,s),s>r))return null}return s!==-1/0?t.at(s,e):t.at(r,e),e}intersectsRay(t){return this.intersectRay(t,oT)!==null}makeEmpty(){return this.faces=[],this.vertices=[],this}addVertexToFace(t,e){return t.face=e,e.outside===null?this.assigned.append(t):this.assigned.insertBefore(e.outside,t),e.outside=t,this}removeVertexFromFace(t,e){return t===e.outside&&(t.next!==null&&t.next.face===e?e.outside=t.next:e.outside=null),this.assigned.remove(t),this}removeAllVerticesFromFace(t){if(t.outside!==null){let e=t.outside,n=t.outside;for(;n.next!==null&&n.next.face===t;)n=n.next;return this.assigned.removeSubList(e,n),e.prev=n.next=null,t.outside=null,e}}deleteFaceVertices(t,e){let n=this.removeAllVerticesFromFace(t);if(n!==void 0)if(e===void 0)this.unassigned.appendChain(n);else{let s=n;do{let r=s.next;e.distanceToPoint(s.point)>this.tolerance?this.addVertexToFace(s,e):this.unassigned.append(s),s=r}while(s!==null)}return this}resolveUnassignedPoints(t){if(this.unassigned.isEmpty()===!1){let e=this.unassigned.first();do{let n=e.next,s=this.tolerance,r=null;for(let o=0;o<t.length;o++){let a=t[o];if(a.mark===yc){let l=a.distanceToPoint(e.point);if(l>s&&(s=l,r=a),s>1e3*this.tolerance)break}}r!==null&&this.addVertexToFace(e,r),e=n}while(e!==null)}return this}computeExtremes(){let t=new D,e=new D,n=[],s=[];for(let r=0;r<3;r++)n[r]=s[r]=this.vertices[0];t.copy(this.vertices[0].point),e.copy(this.vertices[0].point);for(let r=0,o=this.vertices.length;r<o;r++){let a=this.vertices[r],l=a.point;for(let c=0;c<3;c++)l.getComponent(c)<t.getComponent(c)&&(t.setComponent(c,l.getComponent(c)),n[c]=a);for(let c=0;c<3;c++)l.getComponent(c)>e.getComponent(c)&&(e.setComponent(c,l.getComponent(c)),s[c]=a)}return this.tolerance=3*Number.EPSILON*(Math.max(Math.abs(t.x),Math.abs(e.x))+Math.max(Math.abs(t.y),Math.abs(e.y))+Math.max(Math.abs(t.z),Math.abs(e.z))),{min:n,max:s}}computeInitialHull(){let t=this.vertices,e=this.computeExtremes(),n=e.min,s=e.max,r=0,o=0;for(let u=0;u<3;u++){let d=s[u].point.getComponent(u)-n[u].point.getComponent(u);d>r&&(r=d,o=u)}let a=n[o],l=s[o],c,h;r=0,R0.set(a.point,l.point);for(let u=0,d=this.vertices.length;u<d;u++){let m=t[u];if(m!==a&&m!==l){R0.closestPointToPoint(m.point,!0,P0);let _=P0.distanceToSquared(m.point);_>r&&(r=_,c=m)}}r=-1,ad.setFromCoplanarPoints(a.point,l.point,c.point);for(let u=0,d=this.vertices.length;u<d;u++){let m=t[u];if(m!==a&&m!==l&&m!==c){let _=Math.abs(ad.distanceToPoint(m.point));_>r&&(r=_,h=m)}}let f=[];if(ad.distanceToPoint(h.point)<0){f.push(Ri.create(a,l,c),Ri.create(h,l,a),Ri.create(h,c,l),Ri.create(h,a,c));for(let u=0;u<3;u++){let d=(u+1)%3;f[u+1].getEdge(2).setTwin(f[0].getEdge(d)),f[u+1].getEdge(1).setTwin(f[d+1].getEdge(0))}}else{f.push(Ri.create(a,c,l),Ri.create(h,a,l),Ri.create(h,l,c),Ri.create(h,c,a));for(let u=0;u<3;u++){let d=(u+1)%3;f[u+1].getEdge(2).setTwin(f[0].getEdge((3-u)%3)),f[u+1].getEdge(0).setTwin(f[d+1].getEdge(1))}}for(let u=0;u<4;u++)this.faces.push(f[u]);for(let u=0,d=t.length;u<d;u++){let m=t[u];if(m!==a&&m!==l&&m!==c&&m!==h){r=this.tolerance;let _=null;for(let g=0;g<4;g++){let p=this.faces[g].distanceToPoint(m.point);p>r&&(r=p,_=this.faces[g])}_!==null&&this.addVertexToFace(m,_)}}return this}reindexFaces(){let t=[];for(let e=0;e<this.faces.length;e++){let n=this.faces[e];n.mark===yc&&t.push(n)}return this.faces=t,this}nextVertexToAdd(){if(this.assigned.isEmpty()===!1){let t,e=0,n=this.assigned.first().face,s=n.outside;do{let r=n.distanceToPoint(s.point);r>e&&(e=r,t=s),s=s.next}while(s!==null&&s.face===n);return t}}computeHorizon(t,e,n,s){this.deleteFaceVertices(n),n.mark=rT;let r;e===null?r=e=n.getEdge(0):r=e.next;do{let o=r.twin,a=o.face;a.mark===yc&&(a.distanceToPoint(t)>this.tolerance?this.computeHorizon(t,o,a,s):s.push(r)),r=r.next}while(r!==e);return this}addAdjoiningFace(t,e){let n=Ri.create(t,e.tail(),e.head());return this.faces.push(n),n.getEdge(-1).setTwin(e.twin),n.getEdge(0)}addNewFaces(t,e){this.newFaces=[];let n=null,s=null;for(let r=0;r<e.length;r++){let o=e[r],a=this.addAdjoiningFace(t,o);n===null?n=a:a.next.setTwin(s),this.newFaces.push(a.face),s=a}return n.next.setTwin(s),this}addVertexToHull(t){let e=[];return this.unassigned.clear(),this.removeVertexFromFace(t,t.face),this.computeHorizon(t.point,null,t.face,e),this.addNewFaces(t,e),this.resolveUnassignedPoints(this.newFaces),this}cleanup(){return this.assigned.clear(),this.unassigned.clear(),this.newFaces=[],this}compute(){let t;for(this.computeInitialHull();(t=this.nextVertexToAdd())!==void 0;)this.addVertexToHull(t);return this.reindexFaces(),this.cleanup(),this}},Ri=class i{constructor(){this.normal=new D,this.midpoint=new D,this.area=0,this.constant=0,this.outside=null,this.mark=yc,this.edge=null}static create(t,e,n){let s=new i,r=new oa(t,s),o=new oa(e,s),a=new oa(n,s);return r.next=a.prev=o,o.next=r.prev=a,a.next=o.prev=r,s.edge=r,s.compute()}getEdge(t){let e=this.edge;for(;t>0;)e=e.next,t--;for(;t<0;)e=e.prev,t++;return e}compute(){let t=this.edge.tail(),e=this.edge.head(),n=this.edge.next.head();return xc.set(t.point,e.point,n.point),xc.getNormal(this.normal),xc.getMidpoint(this.midpoint),this.area=xc.getArea(),this.constant=this.normal.dot(this.midpoint),this}distanceToPoint(t){return this.normal.dot(t)-this.constant}},oa=class{constructor(t,e){this.vertex=t,this.prev=null,this.next=null,this.twin=null,this.face=e}head(){return this.vertex}tail(){return this.prev?this.prev.vertex:null}length(){let t=this.head(),e=this.tail();return e!==null?e.point.distanceTo(t.point):-1}lengthSquared(){let t=this.head(),e=this.tail();return e!==null?e.point.distanceToSquared(t.point):-1}setTwin(t){return this.twin=t,t.twin=this,this}},ld=class{constructor(t){this.point=t,this.prev=null,this.next=null,this.face=null}},Mc=class{constructor(){this.head=null,this.tail=null}first(){return this.head}last(){return this.tail}clear(){return this.head=this.tail=null,this}insertBefore(t,e){return e.prev=t.prev,e.next=t,e.prev===null?this.head=e:e.prev.next=e,t.prev=e,this}insertAfter(t,e){return e.prev=t,e.next=t.next,e.next===null?this.tail=e:e.next.prev=e,t.next=e,this}append(t){return this.head===null?this.head=t:this.tail.next=t,t.prev=this.tail,t.next=null,this.tail=t,this}appendChain(t){for(this.head===null?this.head=t:this.tail.next=t,t.prev=this.tail;t.next!==null;)t=t.next;return this.tail=t,this}remove(t){return t.prev===null?this.head=t.next:t.prev.next=t.next,t.next===null?this.tail=t.prev:t.next.prev=t.prev,this}removeSubList(t,e){return t.prev===null?this.head=e.next:t.prev.next=e.next,e.next===null?this.tail=t.prev:e.next.prev=t.prev,this}isEmpty(){return this.head===null}};var mr=class extends ve{constructor(t=[]){super();let e=[],n=[],r=new vc().setFromPoints(t).faces;for(let o=0;o<r.length;o++){let a=r[o],l=a.edge;do{let c=l.head().point;e.push(c.x,c.y,c.z),n.push(a.normal.x,a.normal.y,a.normal.z),l=l.next}while(l!==a.edge)}this.setAttribute("position",new Qt(e,3)),this.setAttribute("normal",new Qt(n,3))}};function aa(i){return i.kind==="sphere"?new no(i.radius,32,20):i.kind==="pole"?new fs(i.radius,i.radius,i.size[2],32,1):new mr(lT(i.corners??aT(i.size),i.rounding??0))}function aT([i,t,e]){let n=[-.5,.5];return n.flatMap(s=>n.flatMap(r=>n.map(o=>[s*i,r*t,o*e])))}function lT(i,t){let e=i.map(r=>ce(r));if(t<=0)return e;let n=new Cl(t,2).getAttribute("position"),s=[];for(let r of e)for(let o=0;o<n.count;o+=1)s.push(new D().fromBufferAttribute(n,o).add(r));return s}var cT=.3,bc=class{constructor(t,e){this.group=new Be;let n=e.hairline("detected-wire"),s=e.translucent("detected-wire",.12),r=t.obstacles.filter(a=>a.known&&!ra(a));this.known=r.map(a=>{let l=new on(D0(a),n);return Ei(a.quaternion,l.quaternion),a.position&&ce(a.position,l.position),this.group.add(l),{mesh:l,channel:a.channel?t.channel(a.channel):null}}),this.run=t,this.tracks=[];let o=aa({kind:"box",radius:0,size:[1,1,1]});this.box={skin:o,frame:new ci(o)},this.looks={skin:s,wire:n},this.boxes=[],this.grow()}grow(){for(let t of this.run.tracks.slice(this.tracks.length)){let e=new on(D0(t),this.looks.wire);e.quaternion.copy(gf(t.yaw)),e.visible=!1,this.group.add(e),this.tracks.push({mesh:e,channel:this.run.channel(t.channel)})}}update(t){if(!this.group.visible)return;for(let{mesh:n,channel:s}of this.known)s&&ce(s.at(t),n.position);for(let{mesh:n,channel:s}of this.tracks)n.visible=s!==null&&hT(s,t),n.visible&&ce(s.at(t),n.position);let e=0;for(let{start:n,end:s,position:r,size:o,yaw:a}of this.run.standing){if(t<n||s!==null&&t>=s)continue;let l=this.boxes[e]??this.newBox();l.visible=!0,ce(r,l.position),l.scale.copy(Rm(o)),l.quaternion.copy(gf(a)),e+=1}for(let n of this.boxes.slice(e))n.visible=!1}newBox(){let t=new Be;return t.add(new xe(this.box.skin,this.looks.skin),new on(this.box.frame,this.looks.wire)),this.boxes.push(t),this.group.add(t),t}get isEmpty(){return this.known.length===0&&this.tracks.length===0&&this.run.standing.length===0}},I0=24,L0=.015;function D0(i){let{kind:t,radius:e,size:n}=i;if(t!=="sphere"&&t!=="pole")return U0(new ci(aa(i),25));let s=[],r=o=>{for(let a=0;a<I0;a+=1)for(let l of[a,a+1]){let c=2*Math.PI*l/I0;s.push(...o(Math.cos(c)*e,Math.sin(c)*e))}};if(t==="sphere"){r((o,a)=>[o,0,a]);for(let o of[0,.25,.5,.75]){let[a,l]=[Math.cos(o*Math.PI),Math.sin(o*Math.PI)];r((c,h)=>[c*a,h,c*l])}}else{let o=n[2]/2;for(let a of[-1,-.5,0,.5,1])r((l,c)=>[l,a*o,c]);for(let a=0;a<6;a+=1){let[l,c]=[Math.cos(a*Math.PI/3)*e,Math.sin(a*Math.PI/3)*e];s.push(l,-o,c,l,o,c)}}return U0(new ve().setAttribute("position",new Qt(s,3)))}function U0(i){i.computeBoundingBox();let{x:t,y:e,z:n}=i.boundingBox.getSize(new D),[s,r,o]=[t,e,n].map(a=>1+2*L0/Math.max(a,L0));return i.scale(s,r,o)}function hT(i,t){let e=i.t[i.rowAt(t)];return t>=e&&t-e<cT}var N0=.03,F0=24,la=class{constructor(t,e,n,s){this.run=t,this.palette=e,this.group=new Be,this.position=t.flown("position"),this.attitude=t.flown("attitude");let r=n==="ghost";this.tension=r?null:t.channel("truth.tension");let o=h=>r?e.translucent("series-7",.45):e.solid(h);this.payload=cd(t,o("payload"),e.hairline(r?"series-7":"background",r?1:.8)),this.group.add(this.payload);let a=t.meta.disc_radius??.3,l={body:o("uav"),heading:o("heading"),disc:e.translucent(r?"series-7":"uav",r?.2:.3),rim:e.hairline(r?"series-7":"uav")};this.uavs=[];for(let h=1;t.has(`truth.uav${h}.position`);h+=1){let f=fT(a,l);this.group.add(f),s&&(s.add(`${h}`,"vehicle").position=f.position),this.uavs.push({mesh:f,position:t.channel(`truth.uav${h}.position`),attitude:t.channel(`truth.uav${h}.attitude`)})}let c=new fs(N0,N0,1,8);this.attachments=(t.meta.attachments??[]).map(h=>ce(h)),this.links=this.uavs.slice(0,this.attachments.length).map(()=>{let h=new xe(c,o("link"));return this.group.add(h),h}),this.force=this.scale(),this.rim=Array.from({length:F0},(h,f)=>{let u=2*Math.PI*f/F0;return new D(a*Math.cos(u),0,a*Math.sin(u))}),this.corners=(t.meta.hull??[]).map(h=>ce(h)),this.hull=new Be,this.hull.visible=this.uavs.length>0,this.skin=new xe(new ve,e.translucent("flown",.1)),this.edges=new on(new ve,e.hairline("flown",.55)),this.hull.add(this.skin,this.edges)}scale(){return this.tension?dT(this.tension,.02):{middle:0,reach:1}}isOutgrown(){let{middle:t,reach:e}=this.scale();return Math.abs(t-this.force.middle)+Math.abs(e-this.force.reach)>.25*this.force.reach}update(t){if(!this.position||!this.attitude)return;ce(this.position.at(t),this.payload.position),Ei(this.attitude.at(t),this.payload.quaternion);for(let{mesh:r,position:o,attitude:a}of this.uavs)ce(o.at(t),r.position),a&&Ei(a.at(t),r.quaternion);let e=this.tension?.at(t),n=new D,s=new D;this.links.forEach((r,o)=>{n.copy(this.attachments[o]).applyQuaternion(this.payload.quaternion).add(this.payload.position),s.copy(this.uavs[o].mesh.position).sub(n);let a=s.length();r.position.copy(n).addScaledVector(s,.5),r.scale.set(1,Math.max(a,.001),1),r.quaternion.setFromUnitVectors(uT,s.normalize()),e&&r.material.color.copy(this.palette.diverging((e[o]-this.force.middle)/this.force.reach))}),this.hull.visible&&this.updateHull()}updateHull(){let t=this.corners.map(e=>O0(e,this.payload));for(let{mesh:e}of this.uavs)t.push(...this.rim.map(n=>O0(n,e)));t.length<4||(this.skin.geometry.dispose(),this.edges.geometry.dispose(),this.skin.geometry=new mr(t),this.edges.geometry=new ci(this.skin.geometry,20))}},uT=new D(0,1,0);function O0(i,t){return i.clone().applyQuaternion(t.quaternion).add(t.position)}function cd(i,t,e){let n=(i.meta.hull??[]).map(o=>ce(o)),s=n.length>=4?new mr(n):new Vi(1,.5,1),r=new xe(s,t);return r.add(new on(new ci(s,15),e)),r}function fT(i,t){let e=new Be,n=new xe(new El(i,32),t.disc);n.rotation.x=-Math.PI/2;let s=new ve,r=Array.from({length:32},(l,c)=>[Math.cos(c*Math.PI/16)*i,0,Math.sin(c*Math.PI/16)*i]);s.setAttribute("position",new Qt(r.flat(),3));let o=new xe(new Vi(.45*i,.3*i,.7*i),t.body),a=new xe(new Tl(.22*i,.5*i,12),t.heading);return a.rotation.x=-Math.PI/2,a.position.set(0,0,-.7*i),e.add(n,new yl(s,t.rim),o,a),e}function dT(i,t){let e=i.series.flatMap(r=>Array.from(r).filter(Number.isFinite)).sort((r,o)=>r-o),n=e[e.length>>1]??0,s=e.map(r=>Math.abs(r-n)).sort((r,o)=>r-o);return{middle:n,reach:Math.max(s[Math.floor((1-t)*(s.length-1))]??0,.1)}}var Sc=class{constructor(t,e){this.position=t.meta.source==="estimate"?null:t.channel("estimate.payload.position"),this.attitude=t.channel("estimate.payload.attitude"),this.mesh=cd(t,e.translucent("estimate",.2),e.hairline("estimate")),this.mesh.visible=this.position!==null}update(t){!this.position||!this.mesh.visible||(ce(this.position.at(t),this.mesh.position),this.attitude&&Ei(this.attitude.at(t),this.mesh.quaternion))}};var pT=1,mT=500,gT=[1,2,5,10,20,50,100,200,500,1e3],B0=.5,_T=16;function z0(i){let t=[1/0,1/0,-1],e=[-1/0,-1/0,0],n=(l,c=0)=>{for(let h=0;h<3;h+=1)Number.isFinite(l[h])&&(t[h]=Math.min(t[h],l[h]-c),e[h]=Math.max(e[h],l[h]+c))},s=l=>{let c=i.channel(l);if(!c)return;let h=Math.max(1,Math.floor(c.t.length/mT));for(let f=0;f<c.t.length;f+=h)n(c.row(f),1)};for(let l of[`${i.meta.source}.payload.position`,"reference.position"])s(l);let r=t[2]-(i.meta.link_length??3)-.5;i.names("obstacle.").forEach(s);for(let l of i.obstacles)if(l.position){n(l.position,l.radius);for(let c of l.corners??[])n(xT(c,l))}for(let l of i.meta.fence?.boundary??[])for(let[c,h]of l)n([c,h,0]);Number.isFinite(t[0])||n([0,0,0],2),t[2]=Math.min(r,Math.max(t[2],r-pT)),e[2]=0;let o=Math.max(e[0]-t[0],e[1]-t[1]),a=gT.find(l=>o/l<=_T)??2e3;for(let l of[0,1])t[l]=a*Math.floor(t[l]/a-B0),e[l]=a*Math.ceil(e[l]/a+B0);return{low:t,high:e,step:a}}function xT(i,{position:t,quaternion:e}){return Cm(ce(i).applyQuaternion(Ei(e)).add(ce(t)))}function H0(i,t,e,n){let s=new Be,{low:[r,o],high:[a,l],step:c}=t,h=new xe(new to(l-o,a-r),e.flat("ground"));h.rotation.x=-Math.PI/2,h.position.set((o+l)/2,-.02,-(r+a)/2),h.renderOrder=-2,s.add(h);let f=[],u=[],d=S=>Math.abs(S/(5*c)-Math.round(S/(5*c)))<1e-6;for(let S=r;S<=a+1e-6;S+=c)(d(S)?u:f).push(o,0,-S,l,0,-S);for(let S=o;S<=l+1e-6;S+=c)(d(S)?u:f).push(S,0,-r,S,0,-a);s.add(V0(f,e.hairline("muted",.16)),V0(u,e.hairline("muted",.5)));let m=2*c,_=.35*c,g=S=>m*Math.ceil((S+.8*c)/m);for(let S=g(o);S<l;S+=m)n.add(k0("E",S),"mark").position.set(S,0,-r-_);for(let S=g(r);S<a;S+=m)n.add(k0("N",S),"mark").position.set(o+_,0,-S);let p=new xe(new Rl(yT(c)),e.flat("text"));return p.rotation.x=-Math.PI/2,p.position.set(l-.5*c,0,-(a-2.3*c)),s.add(p),n.add("N","north").position.set(l-.5*c,0,-(a+.4*c)),s.add(...vT(i,e)),s}function k0(i,t){return t===0?`${i} 0 m`:`${t}`.replace("-","−")}function V0(i,t){let e=new ve().setAttribute("position",new Qt(i,3)),n=new on(e,t);return n.renderOrder=-1,n}function yT(i){let t=[[-.06,0],[.06,0],[.06,1.3],[.28,1.3],[0,2],[-.28,1.3],[-.06,1.3]],e=new Us;return t.forEach(([n,s],r)=>r?e.lineTo(n*i,s*i):e.moveTo(n*i,s*i)),e}function vT(i,t){let{pad:e,hull:n}=i.meta,s=i.flown("position");if(!e?.thickness||!n?.length||!s)return[];let r=[0,1].map(u=>{let d=n.map(m=>m[u]);return[Math.min(...d)-e.margin,Math.max(...d)+e.margin]}),[o,a]=r.map(([u,d])=>d-u),l=new xe(new Vi(a,e.thickness,o),t.solid("reference")),[c,h]=s.row(0),f=[c+(r[0][0]+r[0][1])/2,h+(r[1][0]+r[1][1])/2,-e.thickness/2];return ce(f,l.position),[l]}var wc=class{constructor(t,e,n,s){this.group=new Be,this.formation=t;let r=new us({color:0,transparent:!0,opacity:.28,depthWrite:!1,stencilWrite:!0,stencilRef:1,stencilFunc:mm,stencilZPass:pm});n.materials.push({colour:null,material:r}),n.onChange(()=>{r.opacity=n.scheme.matches?.6:.28});let o=new Be;o.scale.y=1e-4,o.position.y=.004,this.group.add(o),this.shadows=[];let a=[t.payload,...t.uavs.map(({mesh:l})=>l),...t.links,...e.obstacles.map(({mesh:l})=>l)];for(let l of a){let c=l.clone(),h=[];c.traverse(f=>{f instanceof xe?(f.material=r,f.renderOrder=-1):(f instanceof on||"isLine"in f)&&h.push(f)});for(let f of h)f.removeFromParent();o.add(c),this.shadows.push({body:l,shadow:c})}this.bodies=[t.payload,...e.obstacles.map(({mesh:l})=>l)],this.drops=new on(new ve().setAttribute("position",new Qt(new Float32Array(6*this.bodies.length),3)),n.hairline("muted",.8)),this.drops.frustumCulled=!1,this.group.add(this.drops),this.label=s.add("","height")}update(){for(let{body:r,shadow:o}of this.shadows)o.position.copy(r.position),o.quaternion.copy(r.quaternion),o.scale.copy(r.scale);let t=this.drops.geometry.getAttribute("position");this.bodies.forEach(({position:{x:r,y:o,z:a}},l)=>{t.setXYZ(2*l,r,Math.max(o,0),a),t.setXYZ(2*l+1,r,0,a)}),t.needsUpdate=!0;let{x:e,y:n,z:s}=this.formation.payload.position;this.label.position.set(e,n-Math.min(n/2,1.5),s),this.label.say(`${n.toFixed(1)} m up`),this.label.visible=n>1&&this.group.visible}};var Ec=8,G0={clearance:[[0,-.5,14,0],[-.5,0,0,12],[-.5,-1,0,-12],[-1,-.5,-14,0]],contact:[[0,-.5,14,0]],waypoint:[[-.5,-.5,0,0]],obstacle:[[-.5,-1,0,-2],[-1,-1,-Ec,0],[0,-1,Ec,0]],vehicle:[[-.5,-1,0,-10],[-.5,0,0,10]],height:[[0,-.5,Ec,0],[-1,-.5,-Ec,0]],north:[[-.5,-.5,0,0]],mark:[[-.5,-.5,0,0]]},ud=Object.keys(G0),MT=ud.indexOf("contact"),bT=ud.indexOf("obstacle"),Tc=class{constructor(t){this.element=O("div.scene-labels",{"aria-hidden":"true"}),t.append(this.element),this.labels=[],this.visible=!0}add(t,e){let n=new hd(t,e);return this.labels.push(n),this.labels.sort((s,r)=>s.rank-r.rank),this.element.append(n.element),n}place(t,e,n,s=[]){let r=new D,o=s.map(a=>{r.copy(a).project(t);let[l,c]=[(.5+.5*r.x)*e,(.5-.5*r.y)*n];return[l-4,c-4,l+4,c+4]});for(let a of this.labels){r.copy(a.position).project(t);let l=r.z>-1&&r.z<1&&Math.abs(r.x)<1.1&&Math.abs(r.y)<1.1,c=(.5+.5*r.x)*e,h=(.5-.5*r.y)*n,f=l&&a.visible&&a.layer()&&(this.visible||a.rank<=MT)?a.spot(c,h,o,e):null;a.element.hidden=!f,f&&(o.push(f),a.element.style.transform=`translate(${f[0].toFixed(1)}px, ${f[1].toFixed(1)}px)`)}}dispose(){this.element.remove()}},hd=class{constructor(t,e){this.kind=e,this.rank=ud.indexOf(e),this.text=t,this.element=O(`div.scene-label.${e}`,{hidden:!0},t),this.size=null,this.position=new D,this.visible=!0,this.layer=()=>!0}say(t){t!==this.text&&(this.text=t,this.element.textContent=t,this.size=null)}spot(t,e,n,s){this.size??=[this.element.offsetWidth,this.element.offsetHeight];let[r,o]=this.size,a=G0[this.kind].map(([c,h,f,u])=>{let d=t+c*r+f,m=t>0&&t<s?Math.max(2,Math.min(d,s-r-2)):d,_=e+h*o+u;return[m,_,m+r,_+o]});return a.find(([c,h,f,u])=>n.every(d=>f<d[0]||c>d[2]||u<d[1]||h>d[3]))??(this.rank<bT?a[0]:null)}};function Ac(i,t){let e=new Set([0,i.length-1]),n=[[0,i.length-1]];for(let s=n.pop();s;s=n.pop()){let[r,o]=s,[a,l]=[0,t];for(let c=r+1;c<o;c+=1){let h=ST(i[c],i[r],i[o]);h>l&&([a,l]=[c,h])}a&&(e.add(a),n.push([r,a],[a,o]))}return i.filter((s,r)=>e.has(r))}function W0(i,t){let e=0;return i.flatMap((n,s)=>s>0&&Math.hypot(...[0,1,2].map(r=>n[r]-i[e][r]))<t?[]:(e=s,[s]))}function ST(i,t,e){let[n,s]=[0,0];for(let o=0;o<3;o+=1)n+=(i[o]-t[o])*(e[o]-t[o]),s+=(e[o]-t[o])**2;let r=s>0?Math.min(Math.max(n/s,0),1):0;return Math.hypot(...[0,1,2].map(o=>i[o]-t[o]-r*(e[o]-t[o])))}var wT=.25,ET=.02,TT=.05,Cc=class{constructor(t,e,n){this.group=new Be,this.ray=new Ol;let s=e.hairline("obstacle-edge",.7),r=t.obstacles.filter(a=>!ra(a));this.obstacles=r.map(a=>{let l=aa(a),c=new xe(l,e.solid("obstacle",{transparent:!0}));Ei(a.quaternion,c.quaternion),a.kind!=="sphere"&&c.add(new on(new ci(l,25),s)),a.position&&ce(a.position,c.position);let h=new Vn().setFromObject(c,!0).max.y-c.position.y;this.group.add(c);let f=a.channel?t.channel(a.channel):null,u=n.add(a.known?a.name:`${a.name} (not on the map)`,"obstacle");return u.layer=()=>this.group.visible,{mesh:c,channel:f,label:u,top:h}});let o=e.line("obstacle",1.5,{transparent:!0,opacity:.5});for(let{channel:a}of this.obstacles){if(!a)continue;let l=new Ci(o),c=Math.max(1,Math.floor(a.t.length/1e3)),h=Array.from({length:Math.ceil(a.t.length/c)},(f,u)=>a.row(u*c));l.setPoints(Ac(h,ET)),this.group.add(l)}}hiding(t,e){let n=e.clone().sub(t);return this.ray.far=n.length()-TT,this.ray.set(t,n.normalize()),this.obstacles.filter(({mesh:s})=>this.ray.intersectObject(s,!1).length>0)}reveal(t,e){let n=new Set(e.flatMap(s=>this.hiding(t(s),s)));for(let s of this.obstacles){let{material:r}=s.mesh;r.opacity=n.has(s)?wT:1,r.depthWrite=r.opacity===1}}update(t){for(let{mesh:e,channel:n,label:s,top:r}of this.obstacles)n&&ce(n.at(t),e.position),e.updateMatrixWorld(),s.position.copy(e.position),s.position.y+=r}};var AT=["#440154","#46327e","#365c8d","#277f8e","#1fa187","#4ac16d","#a0da39","#fde725"],Rc=class{constructor(){this.materials=[],this.listeners=[],this.scheme=matchMedia("(prefers-color-scheme: dark)"),this.change=()=>this.refresh(),this.scheme.addEventListener("change",this.change)}colour(t){return new oe(bn(t)||"#888888")}onChange(t){this.listeners.push(t),t()}refresh(){for(let{colour:t,material:e}of this.materials)t&&e.color.copy(this.colour(t));for(let t of this.listeners)t()}solid(t,e={}){return this.keep(t,new Il(e))}translucent(t,e,n={}){let s={transparent:!0,opacity:e,depthWrite:!1,side:yi,forceSinglePass:!0};return this.keep(t,new us({...s,...n}))}flat(t,e={}){return this.keep(t,new us(e))}hairline(t,e=1){return this.keep(t,new Ho({transparent:e<1,opacity:e}))}line(t,e,n={}){return this.keep(t,new ms({linewidth:e,...n}))}colouredLine(t){let e=new ms({linewidth:t,vertexColors:!0});return this.materials.push({colour:null,material:e}),e}keep(t,e){return e.color.copy(this.colour(t)),this.materials.push({colour:t,material:e}),e}sequential(t){let e=Math.min(Math.max(t,0),1);return X0(AT,this.scheme.matches?.3+.7*e:.9*e)}diverging(t){let e=this.scheme.matches?"#d8dde3":"#b8bec6",n=this.scheme.matches?["#ff7f32","#2f9be8"]:["#c04a00","#005f9e"];return X0([n[0],e,n[1]],.5+.5*Math.min(Math.max(t,-1),1))}dispose(){this.scheme.removeEventListener("change",this.change);for(let{material:t}of this.materials)t.dispose()}};function X0(i,t){let e=t*(i.length-1),n=Math.min(Math.floor(e),i.length-2);return new oe(i[n]).lerp(new oe(i[n+1]),e-n)}function q0(i,t,e){return`linear-gradient(to right, ${Array.from({length:9},(s,r)=>`#${i(t+(e-t)*r/8).getHexString()}`).join(", ")})`}var Y0=560,Pc=class{constructor(t,e,n,s,r){let o=[["free","overview"],["follow","follow"],["top","top"]];this.buttons=o.map(([l,c])=>O("button",{type:"button","aria-pressed":"false","data-camera":l,onclick:()=>r.choose(l)},c));let a=(l,c,h)=>O("button",{type:"button",title:c,"aria-label":c,onclick:()=>r.zoom(h)},l);this.cameras=O("div.scene-cameras",{role:"group","aria-label":"camera"},...this.buttons,a("+","nearer",.8),a("−","farther",1.25)),this.key=O("details.scene-key",{open:t.clientWidth>=Y0,ontoggle:()=>r.cover()},O("summary",{},"Key"),O("div",{},...e.map(CT),...n.map(l=>RT(l,s)))),t.append(this.cameras,this.key)}choose(t){for(let e of this.buttons)e.setAttribute("aria-pressed",String(e.dataset.camera===t))}get covered(){let t=this.key.parentElement;return this.key.open&&t!==null&&t.clientWidth>=Y0?this.key.offsetWidth:0}dispose(){this.cameras.remove(),this.key.remove()}};function CT({name:i,colour:t,look:e,shown:n,show:s}){let r=O(`span.scene-swatch.${e}`,{"aria-hidden":"true"},e==="word"?"a1":"");if(r.style.setProperty("--colour",`var(--${t})`),!s)return O("div.scene-row",{},O("span.scene-no-box"),r,i);let o=O("input",{type:"checkbox",checked:n,onchange:()=>s(o.checked)});return O("label.scene-row",{},o,r,i)}function RT({name:i,from:t,between:e="",to:n,scale:s,low:r,high:o},a){let l=O("div.scene-bar");return a.onChange(()=>{l.style.background=q0(s,r,o)}),O("div.scene-legend",{},i,l,O("div.scene-ends",{},O("span",{},t),O("span",{},e),O("span",{},n)))}var PT=4e3,IT=.25,LT=.02,DT=.5;function $0(i,t){let e=new Ci(t.line("reference",1.5));return e.setPoints(fd(i)),e}function fd(i){let t=i.channel("reference.position");return t?Ac(J0(t,3e3).map(e=>t.row(e)),LT):[]}var ca=class{constructor(t,e,n){this.run=t,this.palette=e,this.line=new Ci(n?e.line(n,2):e.colouredLine(3.5)),this.read(),this.fastest=this.scale(),n?this.line.setPoints(this.points):e.onChange(()=>this.paint())}read(){let t=this.run.flown("position"),e=this.run.flown("velocity"),n=t?J0(t,PT):[],s=W0(n.map(r=>t.row(r)),IT).map(r=>n[r]);this.times=s.map(r=>t.t[r]),this.points=s.map(r=>t.row(r)),this.speeds=s.map(r=>e?Math.hypot(...e.row(r)):0)}scale(){return Math.max(.5,Math.ceil(2*Math.max(0,...this.speeds.filter(Number.isFinite)))/2)}isOutgrown(){return this.scale()>this.fastest}grow(){this.read(),this.paint()}paint(){this.line.setPoints(this.points,this.speeds.map(t=>this.palette.sequential(t/this.fastest))),this.update(this.time??0)}update(t){this.time=t;let e=0,n=this.times.length;for(;e<n;){let s=e+n>>1;this.times[s]<=t?e=s+1:n=s}this.line.showFirst(Math.max(e-1,0))}},Ic=class{constructor(t,e){this.group=new Be,this.plans=[{channel:t.channel("horizon.plan"),line:new Ci(e.line("plan",3))},{channel:t.channel("horizon.stop"),line:new Ci(e.line("stop",3,{dashed:!0,dashSize:.15,gapSize:.1}))}];for(let{line:n}of this.plans)this.group.add(n)}update(t){if(this.group.visible)for(let{channel:e,line:n}of this.plans){if(!e)continue;let s=t-e.t[e.rowAt(t)];n.setPoints(s>=0&&s<DT?e.path(t):[])}}get isEmpty(){return this.plans.every(({channel:t})=>t===null)}};function Z0(i,t){let e=i.flown("position"),n=i.events.filter(r=>r.kind==="waypoint");return(i.meta.waypoints??(e?n.map(r=>e.at(r.start)):[])).map((r,o)=>{let a=t.add(`${o+1}`,"waypoint");return ce(r,a.position),a})}function J0(i,t){let e=i.t.length,n=Math.max(1,Math.ceil(e/t)),s=Array.from({length:Math.ceil(e/n)},(r,o)=>o*n);return s.length&&s[s.length-1]!==e-1&&s.push(e-1),s.filter(r=>i.series.every(o=>Number.isFinite(o[r])))}var UT=.001,Lc=class{constructor(t,e){this.margin=e.meta.margin,this.clearance=e.channel("clearance.nearest"),this.position=e.flown("position"),this.velocity=e.flown("velocity"),this.figures={clearance:O("b"),height:O("b"),speed:O("b")};let n=s=>O("div",{},O("span",{},s),this.figures[s]);this.element=O("div.scene-readout",{},this.clearance&&n("clearance"),n("height"),n("speed")),t.append(this.element)}update(t){let{clearance:e,height:n,speed:s}=this.figures;this.position&&(n.textContent=`${(-this.position.at(t)[2]).toFixed(1)} m`),this.velocity&&(s.textContent=`${Math.hypot(...this.velocity.at(t)).toFixed(1)} m/s`);let r=this.clearance?this.clearance.at(t)[0]:NaN,o=r<=UT;e.textContent=o?"contact":Number.isFinite(r)?`${r.toFixed(2)} m`:"–",e.className=o?"contact":r<this.margin?"near":""}dispose(){this.element.remove()}};var NT={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,1],ArrowDown:[0,-1]},FT=new D(.3,.8,.2),OT=60,Dc=class{constructor(t,e,n,s,r){this.element=t,this.run=e;let o=O("canvas.scene-canvas",{role:"img","aria-label":"the flight in three dimensions; arrow keys turn it",tabIndex:0});this.renderer=new pl({canvas:o,antialias:!0,stencil:!0}),t.append(o),this.onKey=f=>this.turn(f),window.addEventListener("keydown",this.onKey,{capture:!0}),this.palette=new Rc,this.labels=new Tc(t),this.world=new ml,this.time=n.time,this.live=n.live,this.frame=0,this.isStale=!0,this.build(e,s);let a=z0(e);this.box=a,this.fence=C0(e,-a.low[2],this.palette,this.labels),this.world.add(H0(e,a,this.palette,this.labels),this.fence);let l=(e.meta.link_length??3)+2;e.clearance&&this.obstacles.update(e.clearance.time);let c=y0(e,this.obstacles,2*l);this.cameras=new hc(o,a,l,c,()=>this.invalidate()),this.panel=new Pc(t,this.parts(s),this.scales(),this.palette,{choose:f=>this.setCamera(f),zoom:f=>this.cameras.zoom(f),cover:()=>this.resize()}),this.readout=new Lc(t,e);let h=Math.max(a.high[0]-a.low[0],a.high[1]-a.low[1])>OT;this.update(),this.resize(),this.setCamera(h||e.clearance||this.live?"follow":"free"),r&&(this.cameras.resume(r),this.panel.choose(r.kind)),this.observer=new ResizeObserver(()=>this.resize()),this.observer.observe(t),this.palette.onChange(()=>{this.world.background=this.palette.colour("sky"),this.stale()}),this.closing=new AbortController,n.onChange(()=>{n.time!==this.time&&(this.time=n.time,this.stale())},this.closing.signal)}build(t,e){let{palette:n,labels:s,world:r}=this;this.sun=new Nl(new oe(16777215),1.7),r.add(this.sun,new Ul(new oe(16777215),new oe(11580602),1.9)),this.formation=new la(t,n,"flown",s),this.ghost=e?new la(e,n,"ghost"):null,this.ghostTrail=e?new ca(e,n,"series-7"):null,this.obstacles=new Cc(t,n,s),this.heights=new wc(this.formation,this.obstacles,n,s),this.estimate=new Sc(t,n),this.detected=new bc(t,n),this.reference=$0(t,n),this.trail=new ca(t,n),this.plans=new Ic(t,n),this.clearance=new _c(t,n,s),this.waypoints=Z0(t,s),r.add(this.formation.group,this.formation.hull,this.obstacles.group,this.heights.group,this.estimate.mesh,this.detected.group,this.reference,this.trail.line,this.plans.group,this.clearance.group),this.ghost&&this.ghostTrail&&r.add(this.ghost.group,this.ghostTrail.line)}parts(t){let{run:e}=this,n=(...r)=>o=>{for(let a of r)a.visible=o;this.stale()},s=[{name:e.meta.source==="truth"?"payload":"payload, as estimated",colour:"payload",look:"area",shown:!0,show:null},this.obstacles.obstacles.length>0&&{name:"obstacles",colour:"obstacle",look:"area",shown:!0,show:n(this.obstacles.group)},this.formation.uavs.length>0&&{name:"formation hull",colour:"flown",look:"glass",shown:!0,show:n(this.formation.hull)},this.estimate.position&&{name:"estimate",colour:"estimate",look:"glass",shown:!0,show:n(this.estimate.mesh)},this.fence.children.length>0&&{name:"fence",colour:"limit",look:"glass",shown:!0,show:n(this.fence)},(!this.detected.isEmpty||this.live)&&{name:"ground’s map",colour:"detected-wire",look:"wire",shown:!0,show:n(this.detected.group)},e.has("reference.position")&&{name:"reference",colour:"reference",look:"thin",shown:!0,show:n(this.reference)},e.has("horizon.plan")&&{name:"plan",colour:"plan",look:"line",shown:!0,show:n(this.plans.plans[0].line)},e.has("horizon.stop")&&{name:"stop plan",colour:"stop",look:"dashed",shown:!0,show:n(this.plans.plans[1].line)},{name:"flown path",colour:"flown",look:"line",shown:!0,show:n(this.trail.line)},{name:"shadows and heights",colour:"muted",look:"thin",shown:!0,show:n(this.heights.group)},{name:"names and numbers",colour:"text",look:"word",shown:!0,show:n(this.labels)},t&&{name:`other run: ${t.meta.run}`,colour:"series-7",look:"glass",shown:!0,show:n(this.ghost.group,this.ghostTrail.line)}];if(e.clearance){let r=o=>{this.clearance.always=o,this.stale()};s.push({name:"least clearance, always",colour:"clearance",look:"line",shown:!1,show:r})}return s.filter(r=>!!r)}scales(){let{palette:t}=this,e=[{name:"flown path: speed (m/s)",from:"0",to:`${this.trail.fastest}`,scale:n=>t.sequential(n),low:0,high:1}];if(this.formation.tension){let{middle:n,reach:s}=this.formation.force,[r,o,a]=[n-s,n,n+s].map(l=>l.toFixed(1).replace("-","−"));e.push({name:"links: tension (N)",from:r,between:o,to:a,scale:l=>t.diverging(l),low:-1,high:1})}return e}setCamera(t){this.cameras.set(t),this.panel.choose(t),this.invalidate()}turn(t){let e=NT[t.key],n=this.renderer.domElement;!e||t.target!==n||!n.matches(":focus-visible")||t.ctrlKey||t.altKey||t.metaKey||(t.preventDefault(),t.stopPropagation(),this.cameras.turn(e[0],e[1]))}resize(){let{clientWidth:t,clientHeight:e}=this.element;!t||!e||(this.width=t,this.height=e,this.renderer.setPixelRatio(Math.min(window.devicePixelRatio,2)),this.renderer.setSize(t,e,!1),this.cameras.resize(t,e,this.panel.covered),this.draw())}project(t){let e=this.cameras.current;e.updateMatrixWorld();let{x:n,y:s}=ce(t).project(e);return[(.5+.5*n)*(this.width??0),(.5-.5*s)*(this.height??0)]}payloadPixel(){return this.isStale&&this.update(),this.project(this.run.flown("position").at(this.time))}renderAt(t){this.time=t,this.isStale=!0,this.draw()}stale(){this.isStale=!0,this.invalidate()}invalidate(){this.frame||(this.frame=requestAnimationFrame(()=>this.draw()))}update(){this.isStale=!1;let{time:t}=this;this.formation.update(t),this.ghost?.update(t),this.ghostTrail?.update(t),this.obstacles.update(t),this.heights.update(),this.estimate.update(t),this.detected.update(t),this.trail.update(t),this.plans.update(t),this.clearance.update(t),this.readout.update(t),this.cameras.follow(this.formation.payload.position)}draw(){cancelAnimationFrame(this.frame),this.isStale&&this.update();let t=[this.formation.payload,...this.formation.uavs.map(({mesh:e})=>e)].map(({position:e})=>e);this.obstacles.reveal(e=>this.cameras.eye(e),[...t,...this.clearance.ends]),this.cameras.from(this.sun.position).add(FT),this.renderer.render(this.world,this.cameras.current),this.labels.place(this.cameras.current,this.width??1,this.height??1,this.clearance.ends),cancelAnimationFrame(this.frame),this.frame=0}isOutgrown(){let{low:t,high:e}=this.box,n=this.run.flown("position")?.series.map(s=>s[s.length-1])??[];return[0,1].some(s=>n[s]<t[s]||n[s]>e[s])||this.trail.isOutgrown()||this.formation.isOutgrown()}grow(){this.detected.grow(),this.trail.grow(),this.reference.setPoints(fd(this.run)),this.stale()}dispose(){cancelAnimationFrame(this.frame),this.closing.abort(),this.observer.disconnect(),window.removeEventListener("keydown",this.onKey,{capture:!0}),this.cameras.dispose(),this.panel.dispose(),this.readout.dispose(),this.labels.dispose(),this.world.traverse(t=>t.geometry?.dispose()),this.palette.dispose(),this.renderer.dispose(),this.renderer.forceContextLoss(),this.renderer.domElement.remove()}};var BT=[{name:"phase",kinds:["phase","waypoint"],title:"phases"},{name:"fault",kinds:["fault"],title:"faults"},{name:"alarm",kinds:["isolation","mode","alarm","contact"],title:"alarms"}],K0="M3 1v12l9-6z",zT="M3 1h3v12H3zM8 1h3v12H8z",kT="M2 1h2v12H2zM12 1v12L5 7z",VT="M10 1h2v12h-2zM2 1v12l7-6z";function dd(i){let t=document.createElementNS("http://www.w3.org/2000/svg","svg");t.setAttribute("viewBox","0 0 14 14"),t.setAttribute("class","icon");let e=document.createElementNS("http://www.w3.org/2000/svg","path");return e.setAttribute("d",i),t.append(e),t}function j0(i,t,e){let{begin:n,end:s}=i.meta,r=Math.max(s-n,1e-9),o=m=>`${100*(Math.min(Math.max(m,n),s)-n)/r}%`,a=BT.map(({name:m,kinds:_,title:g})=>{let p=i.events.filter(y=>_.includes(y.kind));if(!p.length)return null;let S=y=>(y.end??(y.kind==="isolation"?s:y.start))-y.start,v=[...p].sort((y,U)=>S(U)-S(y)).map(y=>{let U=y.end===null&&!["isolation","fault"].includes(y.kind),R=U?y.start:y.end??s;return O(`button.band.${y.kind}${U?".instant":""}`,{type:"button",title:HT(y),tabIndex:-1,style:{left:o(y.start),width:U?"":`calc(${o(R)} - ${o(y.start)})`},onclick:()=>t.set(y.start)},y.kind==="phase"&&(R-y.start)/r>.008*y.text.length?y.text:"")});return O("div.lane",{},O("span.lane-name",{},g),O(`div.lane-track.${m}`,{},...v))}),l=O("input",{type:"range",id:"slider",min:String(n),max:String(s),step:"any","aria-label":"time (s)",oninput:()=>t.set(Number(l.value))}),c=(m,_,g)=>O("button",{type:"button","aria-label":_,title:_,onclick:g},m),h=c(dd(K0),"play or pause (space)",()=>t.toggle()),f=O("span.speed",{}),u=O("output.time",{id:"time"}),d=O("div.controls",{},c(dd(kT),"to the start (home)",()=>t.set(n)),h,c(dd(VT),"to the end (end)",()=>t.set(t.end)),c("−","slower (-)",()=>t.changeSpeed(-1)),f,c("+","faster (+)",()=>t.changeSpeed(1)),u,O("span.keys",{},"keys: space, ← →, + −, home, end"));return t.onChange(()=>{l.max=String(t.end),l.value=String(t.time),h.firstElementChild.firstElementChild.setAttribute("d",t.playing?zT:K0),f.textContent=`${t.speed}×`,u.textContent=`${t.time.toFixed(2)} s of ${t.end.toFixed(1)} s`},e),O("section",{id:"timeline"},...a,O("div.lane",{},O("span.lane-name",{},"time"),l),d)}function HT(i){return`${i.end===null?`${i.start.toFixed(2)} s`:`${i.start.toFixed(2)} to ${i.end.toFixed(2)} s`}: ${i.source==="team"?"":`${i.source}: `}${i.text}`}function Q0(i,t,e){let n=r=>{let{t:o}=i.flown("position"),a=0,l=o.length;for(;l-a>1;){let c=a+l>>1;o[c]<=t.time+1e-9?a=c:l=c}t.pause(),t.set(o[Math.min(Math.max(a+r,0),o.length-1)])},s={" ":()=>t.toggle(),ArrowRight:r=>r.shiftKey?t.set(t.time+1):n(1),ArrowLeft:r=>r.shiftKey?t.set(t.time-1):n(-1),"+":()=>t.changeSpeed(1),"=":()=>t.changeSpeed(1),"-":()=>t.changeSpeed(-1),Home:()=>t.set(t.begin),End:()=>t.set(t.end)};document.addEventListener("keydown",r=>{let o=r.target;if(!(o instanceof HTMLInputElement&&o.type!=="range"||r.ctrlKey||r.metaKey||r.altKey||!(r.key in s))){if(r.key===" "&&o.matches("button, summary")){if(o.matches(":focus-visible"))return;o.blur()}r.preventDefault(),r.stopPropagation(),s[r.key](r)}},{capture:!0,signal:e})}var vo=class{constructor(t,e,n,s=!1){this.run=e,this.ghost=n,this.clock=new va(e.meta.begin,e.meta.end,s),this.closing=new AbortController,this.stage=O("section",{id:"scene","aria-label":"scene"}),this.parts=null,this.places={title:O("header"),cards:O("div"),timeline:O("section"),events:O("section")};let r=O("section",{id:"plots"}),{places:o}=this;t.replaceChildren(o.title,O("div.top",{},o.cards,this.stage),o.timeline,km(e,n)??"",o.events,r),this.tell(),Q0(e,this.clock,this.closing.signal),this.scene=this.newScene(),this.plots=new lc(r,e,this.clock,n);let a=e.events.find(({kind:l})=>l==="contact");this.clock.set(s?e.meta.end:a?.start??e.clearance?.time??e.meta.begin)}tell(){let{run:t,clock:e}=this;this.parts?.abort(),this.parts=new AbortController;let{signal:n}=this.parts,s=[".cards","#events .scroll"].map(o=>document.querySelector(o)?.scrollTop??0),r={title:O("header",{},Bm(t)),cards:zm(t,e),timeline:j0(t,e,n),events:kd(t,e,n)};for(let[o,a]of Object.entries(r))this.places[o].replaceWith(a);this.places=r,[".cards","#events .scroll"].forEach((o,a)=>{let l=document.querySelector(o);l&&(l.scrollTop=s[a])})}newScene(t){try{return new Dc(this.stage,this.run,this.clock,this.ghost,t)}catch(e){return console.warn(e),this.stage.replaceChildren(O("p.failed",{},`The scene cannot be shown: ${e.message} (it needs WebGL).`)),this.stage.classList.add("absent"),null}}extend(t){this.run.extend(t)?this.renewScene():this.scene?.grow(),this.clock.extend(this.run.meta.end)}refresh(){this.places.timeline.querySelector(":active, :focus-visible")||this.tell(),this.plots.refresh(),this.scene?.isOutgrown()&&this.renewScene()}renewScene(){this.scene&&(this.scene.dispose(),this.scene=this.newScene(this.scene.cameras))}film(t){return Pm(this.scene,t)}close(){this.clock.pause(),this.clock.listeners=[],this.closing.abort(),this.parts?.abort(),this.scene?.dispose(),this.plots.dispose()}};var GT=2e3;function t_(i,t,e){let n=null,s=0,r=!1;async function o({header:a,blob:l,final:c}){let h=await e(a,l);if(r=c,n&&!c){n.extend(h),s||=window.setTimeout(()=>{s=0,n?.refresh()},GT);return}window.clearTimeout(s),s=0,n?.close(),n=new vo(t,h,void 0,!c),document.title=`${h.meta.mission}, seed ${h.meta.seed}: ${h.meta.outcome}`,Object.assign(window,{report:n})}return new Promise((a,l)=>{let c=new WebSocket(i),h=Promise.resolve();c.onmessage=({data:f})=>{h=h.then(()=>o(JSON.parse(f))),h.catch(l)},c.onclose=()=>h.then(()=>{n?(n.clock.live=!1,n.clock.following=!1,r||(n.run.meta.outcome="connection lost",n.refresh()),a(void 0)):l(new Error("the connection ended before anything was flown"))})})}var ha=document.getElementById("page");async function WT(){let[i,t]=await zd(document);Object.assign(window,{report:new vo(ha,i,t)})}async function XT(){ha.replaceChildren(O("p.waiting",{},"Waiting for the first records of the flight …")),await t_(`ws://${window.location.host}/`,ha,Yc)}async function qT(i){let t=JSON.parse(i.textContent??"");ha.replaceChildren(...Ud(t)),Object.assign(window,{report:{campaign:t}})}var e_=document.querySelector("script.campaign"),YT=document.querySelector("script.live");(e_?qT(e_):YT?XT():WT()).catch(i=>{throw ha.replaceChildren(O("p.failed",{},`The page cannot be shown: ${i.message}`)),i});
