"""Files of Shi's programs and of DDA for Windows, written by hand from what is known of them."""

from __future__ import annotations

GEOMETRY = """\
0.001
7 4
1
1
2
1 1 2
-1  0 21  0 1
20 -1 20 11 1
21 10 -1 10 1
 0 11  0 -1 1
-1  5 21  5 2
10 -1 10 11 3
 5  5  5  5 2
 0  0  1  1 2
 2  2  4  2 1.0D3 50 0.1
 0  0 20  0
 0  0  0  0
10  9
 3  3
15  7
 1  1
"""
"""A domain of 20 x 10 with overshooting boundary lines, two joints and one of no length."""

ANALYSIS = """\
1 100
2 3
0.01 0.001
2.7 26.46 5e6 0.25   -10 -100 1   0 0 0   0 0 0
2.5 24.50 4e6 0.20     0    0 0   0 1 0   1 0 0.5
20 0 0
30 5 1
35 2.5 0
"""
"""Two materials and three joint types in t, kN and kPa."""

BLOCKS = """\
2 0 15
1 0 1
1 1 4
2 9 11
1 0 0
2 1 0
3 1 1
0 0 1
9 9 9
9 9 9
9 9 9
9 9 9
1 1 0
2 1 1
3 2 0.5
9 9 9
9 9 9
9 9 9
9 9 9
0.5 0.5 1
"""
"""A square and a triangle that runs clockwise, with four more slots behind each."""

XML = """\
<?xml version="1.0" encoding="utf-8"?>
<dda:DDA xmlns:dda="http://example.org/dda">
  <dda:Geometry>
    <dda:Edgenodedist distance="0.001"/>
    <dda:Jointlist>
      <dda:Joint type="2">-1 5 21 5</dda:Joint>
      <dda:Joint type="3">10, -1, 10, 11</dda:Joint>
    </dda:Jointlist>
    <dda:Boundlist>
      <dda:Line>-1 0 21 0</dda:Line>
      <dda:Line>20 -1 20 11</dda:Line>
      <dda:Line>21 10 -1 10</dda:Line>
      <dda:Line>0 11 0 -1</dda:Line>
    </dda:Boundlist>
    <dda:Matlinelist><dda:Line type="2">0 0 1 1</dda:Line></dda:Matlinelist>
    <dda:Boltlist><dda:Bolt>2 2 4 2 1e3 50 0.1</dda:Bolt></dda:Boltlist>
    <dda:Fixedpointlist>
      <dda:Line>0 0 20 0</dda:Line>
      <dda:Point>0 0</dda:Point>
    </dda:Fixedpointlist>
    <dda:Loadpointlist><dda:Point>10 9</dda:Point><dda:Point>11 9</dda:Point></dda:Loadpointlist>
    <dda:Measuredpointlist><dda:Point>3 3</dda:Point></dda:Measuredpointlist>
    <dda:Holepointlist><dda:Point>15 7</dda:Point></dda:Holepointlist>
  </dda:Geometry>
  <dda:Analysis>
    <dda:Analysistype type="dynamic"/>
    <dda:Rotation type="linear"/>
    <dda:Gravaccel value="9.8"/>
    <dda:Autopenalty pfactor="50"/>
    <dda:Planestrain flag="1"/>
    <dda:Numtimesteps timesteps="100"/>
    <dda:Maxtimestep maxtimestep="0.001"/>
    <dda:Maxdisplacement maxdisplacement="0.01"/>
    <dda:Saveinterval step="10"/>
    <dda:Loadpoint numpoints="2">0 0 -5; 1 0 -5</dda:Loadpoint>
    <dda:Loadpoint numpoints="2">0 0 0; 1 0 -7</dda:Loadpoint>
    <dda:Blockmaterial>
      <dda:Unitmass>2.7</dda:Unitmass><dda:Unitweight>26.46</dda:Unitweight>
      <dda:Youngsmod>5e6</dda:Youngsmod><dda:Poissonratio>0.25</dda:Poissonratio>
      <dda:Damping>0.02</dda:Damping>
      <dda:Istress>-10 -100 1</dda:Istress><dda:Ivelocity>0 0 0</dda:Ivelocity>
      <dda:Istrain>0 0 0</dda:Istrain>
    </dda:Blockmaterial>
    <dda:Blockmaterial>
      <dda:Unitmass>2.5</dda:Unitmass><dda:Unitweight>24.5</dda:Unitweight>
      <dda:Youngsmod>4e6</dda:Youngsmod><dda:Poissonratio>0.20</dda:Poissonratio>
      <dda:Istrain>0 1e-4 0</dda:Istrain><dda:Ivelocity>1 0 0.5</dda:Ivelocity>
    </dda:Blockmaterial>
    <dda:Jointproperties><dda:Friction>20</dda:Friction><dda:Cohesion>0</dda:Cohesion>
      <dda:Tensile>0</dda:Tensile></dda:Jointproperties>
    <dda:Jointproperties><dda:Friction>30</dda:Friction><dda:Cohesion>5</dda:Cohesion>
      <dda:Tensile>1</dda:Tensile></dda:Jointproperties>
    <dda:Jointproperties><dda:Friction>35</dda:Friction><dda:Cohesion>2.5</dda:Cohesion>
      <dda:Tensile>0</dda:Tensile></dda:Jointproperties>
    <dda:Boltproperties><dda:Stiffness>1e3</dda:Stiffness></dda:Boltproperties>
  </dda:Analysis>
</dda:DDA>
"""
"""The same domain with the same materials."""
